/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * LD_PRELOAD: counts the calls that change files below SNOWBOUGH_FAULT_ROOT, and lets one of them fail.
 *
 * SNOWBOUGH_FAULT=log:FILE   appends a line for each call: open, write, fsync, rename or unlink, and the path
 *                 kill:N     ends the process before call N, counted from 1
 *                 fail:N:E   lets call N fail with errno E
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

enum { kMaxDescriptors = 4096 };

static atomic_long calls;
static long wanted;
static int failure; /* errno, 0: kill */
static int log_descriptor = -1;
static const char* root;
static char paths[kMaxDescriptors][256];

__attribute__((constructor)) static void start(void) {
  root = getenv("SNOWBOUGH_FAULT_ROOT");
  const char* fault = getenv("SNOWBOUGH_FAULT");
  if (!fault || !root) return;
  if (!strncmp(fault, "log:", 4)) {
    log_descriptor = (int)syscall(SYS_openat, AT_FDCWD, fault + 4, O_WRONLY | O_CREAT | O_APPEND, 0666);
  } else if (sscanf(fault, "fail:%ld:%d", &wanted, &failure) != 2) {
    sscanf(fault, "kill:%ld", &wanted);
  }
}

static int is_inside(const char* path) {
  return root && path && !strncmp(path, root, strlen(root)) && !strstr(path, "/logs/");
}

/* Whether the call must fail; errno is set then. */
static int fails(const char* name, const char* path) {
  const long number = atomic_fetch_add(&calls, 1) + 1;
  if (log_descriptor >= 0) {
    char line[400];
    const int length = snprintf(line, sizeof line, "%s %s\n", name, path);
    syscall(SYS_write, log_descriptor, line, length);
  }
  if (number != wanted) return 0;
  if (!failure) syscall(SYS_kill, getpid(), SIGKILL);
  errno = failure;
  return 1;
}

static int opened(int descriptor, const char* path) {
  if (descriptor >= 0 && descriptor < kMaxDescriptors) {
    snprintf(paths[descriptor], sizeof paths[descriptor], "%s", path);
  }
  return descriptor;
}

static const char* path_of(int descriptor) {
  return descriptor >= 0 && descriptor < kMaxDescriptors && paths[descriptor][0] ? paths[descriptor] : NULL;
}

static int open_call(int folder, const char* path, int flags, mode_t mode) {
  const int inside = folder == AT_FDCWD && is_inside(path) && (flags & (O_WRONLY | O_RDWR));
  if (inside && fails("open", path)) return -1;
  const int descriptor = (int)syscall(SYS_openat, folder, path, flags, mode);
  return inside ? opened(descriptor, path) : descriptor;
}

#define MODE_OF(flags)                    \
  mode_t mode = 0;                        \
  if ((flags) & (O_CREAT | O_TMPFILE)) {  \
    va_list rest;                         \
    va_start(rest, flags);                \
    mode = va_arg(rest, mode_t);          \
    va_end(rest);                         \
  }

int open(const char* path, int flags, ...) {
  MODE_OF(flags)
  return open_call(AT_FDCWD, path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  MODE_OF(flags)
  return open_call(AT_FDCWD, path, flags, mode);
}
int openat(int folder, const char* path, int flags, ...) {
  MODE_OF(flags)
  return open_call(folder, path, flags, mode);
}
int openat64(int folder, const char* path, int flags, ...) {
  MODE_OF(flags)
  return open_call(folder, path, flags, mode);
}

int close(int descriptor) {
  if (descriptor >= 0 && descriptor < kMaxDescriptors) paths[descriptor][0] = 0;
  return (int)syscall(SYS_close, descriptor);
}

ssize_t write(int descriptor, const void* bytes, size_t count) {
  const char* path = path_of(descriptor);
  if (path && fails("write", path)) return -1;
  return syscall(SYS_write, descriptor, bytes, count);
}
ssize_t pwrite(int descriptor, const void* bytes, size_t count, off_t offset) {
  const char* path = path_of(descriptor);
  if (path && fails("write", path)) return -1;
  return syscall(SYS_pwrite64, descriptor, bytes, count, offset);
}
ssize_t pwrite64(int descriptor, const void* bytes, size_t count, off64_t offset) {
  return pwrite(descriptor, bytes, count, offset);
}

int fsync(int descriptor) {
  const char* path = path_of(descriptor);
  if (path && fails("fsync", path)) return -1;
  return (int)syscall(SYS_fsync, descriptor);
}

int rename(const char* from, const char* to) {
  if (is_inside(to) && fails("rename", from)) return -1;
  return (int)syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0);
}

int unlink(const char* path) {
  if (is_inside(path) && fails("unlink", path)) return -1;
  return (int)syscall(SYS_unlinkat, AT_FDCWD, path, 0);
}
