// GLSL only: bounds of the snow's surface along paths from neighbours in a window.
#include "repose_window.glsl"

/// Fraction of a bound's rise over a quad below which a change is not passed on.
const float kLeastChange = 4e-3;
/// Fraction of the product of two sides below which a triangle is degenerate, seen from above.
const float kFlat = 1e-4;

/// The bound that a cell passes on to its neighbours.
shared float passed[kReposeWindowCells];
/// Lengths of the links to forward neighbours, in metres of bound; kNoLink: there is none.
shared float lengths[4 * kReposeWindowCells];

/// Length of the link between two neighbours of the window, `offset` apart, in metres of bound.
float length_between(int a, ivec2 offset) {
  const bool forward = offset.y > 0 || (offset.y == 0 && offset.x > 0);
  const ivec2 step = forward ? offset : -offset;
  const int first = forward ? a : a + offset.y * kReposeWindow + offset.x;
  const int k = step.y == 0 ? 0 : step.x == 0 ? 1 : step.x > 0 ? 2 : 3;
  return lengths[k * kReposeWindowCells + first];
}

/// The bound of a corner of a triangle by the paths that cross the opposite side, along which bounds are linear, from
/// `a` to `b`: along the path with the smallest rise, if it crosses the side (Hopf and Lax's formula on a triangle: F.
/// Bornemann and C. Rasch, Finite-element discretization of static Hamilton-Jacobi equations based on a local
/// variational principle, 2006). `length_a`, `length_b`, `side`: lengths of the sides. y: distance of the side.
vec2 over_side(float a, float b, float length_a, float length_b, float side) {
  const float rise = b - a;
  if (!(abs(rise) < side)) {
    return vec2(kUnbounded, 0.0);
  }
  // From the projection of the corner on the side to the side's beginning.
  const float place = (length_b * length_b - length_a * length_a - side * side) / (2.0 * side);
  const float square = length_a * length_a - place * place;
  if (!(square * side * side > kFlat * length_a * length_a * side * side)) {
    return vec2(kUnbounded, 0.0);
  }
  const float away = sqrt(square);
  const float part = rise / side;
  const float flatness = sqrt(1.0 - part * part);
  const float foot = -part * away;
  const bool crosses = foot >= place * flatness && foot <= (place + side) * flatness;
  return vec2(crosses ? a + (away * flatness - part * place) : kUnbounded, away);
}

/// The bound of a cell from its neighbours.
float lowered(int i, float bound, float bare) {
  const ivec2 at = place_in_window(i) + kReposeBorder;
  float least = bound;
  // Around the cell, straight neighbours at even numbers.
  const ivec2 offsets[9] = ivec2[9](ivec2(1, 0), ivec2(1, 1), ivec2(0, 1), ivec2(-1, 1), ivec2(-1, 0), ivec2(-1, -1),
                                 ivec2(0, -1), ivec2(1, -1), ivec2(1, 0));
  float before = kUnbounded;
  float length_before = kNoLink;
  for (int n = 0; n < 9; ++n) {
    const ivec2 offset = offsets[n];
    const ivec2 to = at + offset;
    const bool is_inside = to.x >= 0 && to.x < kReposeWindow && to.y >= 0 && to.y < kReposeWindow;
    const float own_length = is_inside ? length_between(i, offset) : kNoLink;
    const float own = own_length < kNoLink ? passed[to.y * kReposeWindow + to.x] : kUnbounded;
    if (own < kUnbounded) {
      least = min(least, max(own + own_length, bare));
    }
    if (own < kUnbounded && before < kUnbounded) {
      const ivec2 back = offsets[max(n - 1, 0)];
      const float side = length_between((at.y + back.y) * kReposeWindow + at.x + back.x, offset - back);
      const vec2 over =
          side < kNoLink ? over_side(before, own, length_before, own_length, side) : vec2(kUnbounded, 0.0);
      const float now = max(over.x, bare);
      least = now < least - kLeastChange * over.y ? now : least;
    }
    before = own;
    length_before = own_length;
  }
  return least;
}
