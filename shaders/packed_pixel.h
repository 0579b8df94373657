#pragma once

/// A pixel of a tile in one number, and back, without the divisions that a running index would take.
uint packed_pixel(ivec2 pixel) { return uint(pixel.y) << 16 | uint(pixel.x); }
ivec2 unpacked_pixel(uint pixel) { return ivec2(pixel & 0xFFFFu, pixel >> 16); }
