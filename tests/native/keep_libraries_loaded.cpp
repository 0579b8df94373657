// Linked into the tests under the address sanitizer only. Mesa keeps a little memory until the
// process ends, reachable from its own static data. Once its driver is unloaded that data is gone,
// and the leak check reports the memory in an unknown module, which no suppression can name. So
// nothing is unloaded.

extern "C" __attribute__((visibility("default"))) int dlclose(void* /*handle*/) {
  return 0;
}
