#pragma once

// Macros that let one source be a part of a GLSL shader and of a C++ class, so that a pass's arithmetic is written once
// for both engines; see native/snow/step/cpu/kernel.h. In C++ inputs are members, views are pointers, and the formats
// in KERNEL_VIEW are the elements that texelFetch returns. Such a source writes float literals with f, builds short
// vectors from long ones by constructors instead of swizzles, and has only plain input parameters. Why views are buffer
// textures: docs/dev/shaders.md.
#ifdef SNOWBOUGH_GLSL
#define KERNEL_CONSTANT const
/// A struct of so many members.
#define KERNEL_MAKE2(type, a, b) type(a, b)
#define KERNEL_MAKE3(type, a, b, c) type(a, b, c)
#define KERNEL_MAKE4(type, a, b, c, d) type(a, b, c, d)
#define KERNEL_MAKE5(type, a, b, c, d, e) type(a, b, c, d, e)
#define KERNEL_CONST_REF(type) const type
/// A shader's variants have all blocks bound; a kernel's may be null.
#define KERNEL_IS_BOUND(name) true
#define KERNEL_UNIFORM(type, name) uniform type name
#define KERNEL_UNIFORM_BLOCK(block, type, name) layout(std140) uniform block { type name; }
#define KERNEL_BLOCK(block, type, name) layout(std430) buffer block { type name[]; }
#define KERNEL_BLOCK_WRITEONLY(block, type, name) layout(std430) writeonly buffer block { type name[]; }
/// A buffer texture with one to four numbers per element; OpenGL 4.1 has no storage blocks.
#define KERNEL_VIEW_R32UI(name) uniform usamplerBuffer name
#define KERNEL_VIEW_RG32UI(name) uniform usamplerBuffer name
#define KERNEL_VIEW_RGBA32UI(name) uniform usamplerBuffer name
#define KERNEL_VIEW_R32F(name) uniform samplerBuffer name
#define KERNEL_VIEW_RGB32F(name) uniform samplerBuffer name
#define KERNEL_VIEW_RGBA32F(name) uniform samplerBuffer name
#else
#define KERNEL_CONSTANT static constexpr
#define KERNEL_MAKE2(type, a, b) type{a, b}
#define KERNEL_MAKE3(type, a, b, c) type{a, b, c}
#define KERNEL_MAKE4(type, a, b, c, d) type{a, b, c, d}
#define KERNEL_MAKE5(type, a, b, c, d, e) type{a, b, c, d, e}
#define KERNEL_CONST_REF(type) const type&
#define KERNEL_IS_BOUND(name) ((name) != nullptr)
#define KERNEL_UNIFORM(type, name) type name
#define KERNEL_UNIFORM_BLOCK(block, type, name) type name
#define KERNEL_BLOCK(block, type, name) type* name
#define KERNEL_BLOCK_WRITEONLY(block, type, name) type* name
#define KERNEL_VIEW_R32UI(name) const shared::Word* name
#define KERNEL_VIEW_RG32UI(name) const uvec2* name
#define KERNEL_VIEW_RGBA32UI(name) const uvec4* name
#define KERNEL_VIEW_R32F(name) const shared::Number* name
#define KERNEL_VIEW_RGB32F(name) const vec3* name
#define KERNEL_VIEW_RGBA32F(name) const vec4* name
#endif
