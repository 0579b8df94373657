#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>

#include "shaders/lib/snow_shared.h"
#include "snow/scene/projection.h"
#include "snow/step/cpu/scene.h"
#include "snow/step/engine.h"

// The passes of a step on the processor, in their order; what the sky sees is drawn by the
// OcclusionPass of step/cpu/occlusion/occlusion.h. Each has a source of its name.
namespace snowbough::snow::cpu {

/// Evaluates every triangle on the current vertices as the fall of this step meets it: corners in
/// pixels of the grid and depth, slopes, area (shaders/lib/triangle_setup.h). First pass of a step;
/// all others build on it instead of on vertices. On all cores, any thread.
/// `positions` in metres; `corners` gets three elements a triangle and `surface` one.
/// @throws std::invalid_argument when these have not that many.
void set_up_triangles(std::span<const glm::vec3> positions,
                      std::span<const shared::SceneTriangle> triangles,
                      const shared::ProjectionFrame& frame, std::span<glm::vec4> corners,
                      std::span<glm::vec4> surface);

/// Finds what lies at the points of surfaces that are shaded smooth, by the triangles of this step
/// (shaders/lib/smooth_points.h).
void set_up_smooth_points(Scene& scene);

/// Chooses the groups of texels that have anything to do in this step: those on which snow lies or
/// which have a triangle that faces the fall. The passes would change nothing on the others.
void choose_texels(Scene& scene);

/// Marks the groups on which snow lies, after it has moved.
void find_snow(Receiver& receiver);

/// Evaluates area and upward parts of a group's texels, and which parts of these its fragments
/// are, on the current triangles, unless that was done in this pose.
void evaluate_group(const Scene& scene, Receiver& receiver, size_t group);

/// Evaluates area and upward parts of the chosen texels on the current triangles, in steps in which
/// nothing falls; sets what they gain to 0.
void evaluate_texels(Scene& scene);

/// Counts the tile's own pixels in which the sky sees back faces of receivers that gather nothing
/// there: many of them hint at flipped normals.
void count_back_faces(Scene& scene, const Tile& tile);

/// The deposit of a tile, gathered by the chosen texels (shaders/lib/texel_gain.h, where the method
/// stands): adds what they gain to `gain` of their steps, or sets it where this is the step's first
/// tile, after evaluate_group. The scene's `seen` shows the tile and its margin, and kSeenSpare
/// pixels more. Fragment by fragment it would be the same to the bit.
void gather_deposit(Scene& scene, const Tile& tile, bool is_first);

/// Work on one group of a receiver's texels, for any thread.
using GroupWork = std::function<void(Receiver& receiver, size_t group)>;

/// gather_deposit of a single group; `scene` and what it holds must stay as they are meanwhile.
GroupWork deposit_work(Scene& scene, const Tile& tile, bool is_first);

/// Adds the chosen texels' deposit to their heights and lets slide what the slope cannot hold, in
/// closed form over `dt` seconds (shaders/lib/texel_stability.h, where the method stands); adds up
/// each receiver's volumes and visible area, in a fixed order. `before` is called for each group
/// just before: what it leaves is still in the cache.
void apply_stability(Scene& scene, const StabilitySettings& settings, float full_gain, float dt,
                     const GroupWork& before = {});

}  // namespace snowbough::snow::cpu
