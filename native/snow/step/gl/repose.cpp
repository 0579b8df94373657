#include "snow/step/gl/repose.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "shaders/lib/texel_repose.h"
#include "snow/step/gl/driver.h"

namespace snowbough::snow::gl {
namespace {

/// Duration in seconds of a step of kRoundSweeps, and the factor for the longest steps.
constexpr float kUsualStep = 0.25f;
constexpr float kMostWorkFactor = 8.0f;

/// Work-group size of the sweeps: software renderers run the invocations of a group eight at a
/// time.
int32_t sweep_size() {
  return gpu::renders_in_software() ? 8 : 256;
}

int64_t head_offset(int32_t head) {
  return head * static_cast<int64_t>(sizeof(shared::ReposeList));
}

void wait_for_writes() {
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT |
                  GL_COMMAND_BARRIER_BIT);
}

}  // namespace

ReposePass::ReposePass(const std::vector<const SceneObject*>& objects, const SceneBuffers& scene,
                       const gpu::GpuInfo& info)
    : objects_(objects),
      has_moved_(objects.size(), 1),
      sets_(build_repose_buffers(objects, scene, info)),
      local_size_(sweep_size()),
      bounds_({"repose_bounds.comp.glsl"}, {local_size_define(local_size_)}),
      rounds_({"repose_rounds.comp.glsl"}, {local_size_define(local_size_)}),
      write_({"repose_write.comp.glsl"}, {local_size_define(snow::local_size())}) {}

void ReposePass::run(SceneBuffers& scene, const ReposeSettings& settings, float dt) {
  const ReposeLimits limits{static_cast<float>(std::tan(settings.angle)),
                            static_cast<float>(settings.cohesion)};
  const bool has_changed = limits != limits_;
  if ((limits.cohesion > 0.0f) != (limits_.cohesion > 0.0f)) {
    std::fill(has_moved_.begin(), has_moved_.end(), uint8_t{1});
  }
  limits_ = limits;
  round_sweeps_ = static_cast<int32_t>(static_cast<float>(kRoundSweeps) *
                                       std::clamp(dt / kUsualStep, 1.0f, kMostWorkFactor));
  ++step_;
  const bool any_moved =
      std::any_of(has_moved_.begin(), has_moved_.end(), [](uint8_t moved) { return moved != 0; });
  if (any_moved && limits.cohesion > 0.0f && scene.smooth_point_count > 0) find_curvatures(scene);
  for (ReposeBuffers& set : sets_) {
    const bool moves = any_moved && update_pose(scene, set);
    if (moves) find_surface(scene, set);
    clear_lists(set);
    set_cells(scene, set);
    if (moves || has_changed || set.has_two_sided) set_links(scene, set);
    choose(set);
    lower_bounds(set);
    run_rounds(set);
    write(scene, set, dt);
  }
  first_sweep_ += static_cast<uint32_t>(touched_head() + 1);
  std::fill(has_moved_.begin(), has_moved_.end(), uint8_t{0});
}

/// Uploads which receivers have moved; returns whether any has.
bool ReposePass::update_pose(const SceneBuffers& scene, ReposeBuffers& set) {
  bool any = false;
  const std::vector<size_t> numbers = objects_by_slot(scene.layout.plan);
  for (size_t i = 0; i < set.objects.size(); ++i) {
    const size_t number = numbers[static_cast<size_t>(set.first_slot) + i];
    const Bounds& bounds = objects_[number]->bounds;
    shared::ReposeObject& own = set.objects[i];
    own.has_moved = has_moved_[number];
    own.anchor = glm::vec4(glm::vec3(0.5 * (bounds.low + bounds.high)), own.anchor.w);
    any = any || own.has_moved != 0;
  }
  set.object_buffer.write(0,
                          static_cast<int64_t>(set.objects.size() * sizeof(shared::ReposeObject)),
                          set.objects.data());
  return any;
}

void ReposePass::find_curvatures(const SceneBuffers& scene) {
  if (curvatures_.bytes() == 0) {
    curvatures_ = gpu::Buffer(4 * scene.smooth_point_count);
    curvature_view_ = gpu::BufferTexture(curvatures_, GL_R32F);
  }
  curvature_.use();
  curvature_.bind_texture("positions", scene.views.positions);
  curvature_.bind_texture("triangles", scene.views.triangles);
  curvature_.bind_texture("triangle_points", scene.views.triangle_points);
  curvature_.bind_texture("point_begin", scene.views.point_begin);
  curvature_.bind_texture("point_corners", scene.views.point_corners);
  curvature_.bind_texture("point_normals", scene.views.point_normals);
  curvature_.bind("Curvatures", curvatures_);
  curvature_.set("count", static_cast<int32_t>(scene.smooth_point_count));
  curvature_.dispatch_items(scene.smooth_point_count, 64);
  wait_for_writes();
}

void ReposePass::find_surface(const SceneBuffers& scene, const ReposeBuffers& set) {
  const bool has_shading = scene.smooth_point_count > 0;
  const bool is_curved = has_shading && limits_.cohesion > 0.0f;
  std::vector<std::string> defines;
  if (has_shading) defines.emplace_back("WITH_SHADING");
  if (is_curved) defines.emplace_back("WITH_CURVATURE");
  gpu::Program& program = surface_.with(defines);
  for (const TexelBatch& batch : scene.batches) {
    program.use();
    program.bind_texture("positions", scene.views.positions);
    program.bind_texture("triangles", scene.views.triangles);
    program.bind_texture("fragment_begin", batch.views.fragment_begin);
    program.bind_texture("fragments", batch.views.fragments);
    program.bind_texture("places", batch.views.places);
    program.bind_texture("group_slots", batch.views.group_slots);
    if (has_shading) {
      program.bind_texture("triangle_points", scene.views.triangle_points);
      program.bind_texture("point_normals", scene.views.point_normals);
    }
    if (is_curved) program.bind_texture("point_curvatures", curvature_view_);
    program.set("texel_count", batch.count);
    program.set("resolution", scene.groups[static_cast<size_t>(batch.group)].resolution);
    program.set("first_slot", set.first_slot);
    program.set("end_slot", set.end_slot);
    program.bind("Objects", set.object_buffer);
    program.bind("Tables", set.tables);
    program.bind("Points", set.points);
    program.bind("Slopes", set.slopes);
    program.dispatch_items(batch.count, 64);
  }
  wait_for_writes();
}

/// Empties the lists of the step.
void ReposePass::clear_lists(ReposeBuffers& set) const {
  const std::vector<shared::ReposeList> heads(static_cast<size_t>(touched_head()) + 1,
                                              {0, shared::kReposeListRows, 1, 0});
  const auto bytes = static_cast<int64_t>(heads.size() * sizeof(shared::ReposeList));
  if (set.heads.bytes() < bytes) set.heads = gpu::Buffer(bytes);
  set.heads.write(0, bytes, heads.data());
  for (gpu::Buffer& flows : set.end_flows.buffer) flows.clear();
}

void ReposePass::set_cells(const SceneBuffers& scene, const ReposeBuffers& set) {
  for (const ReposeBuffers::Run& run : set.runs) {
    cells_.use();
    cells_.bind_image("height_map", scene.groups[static_cast<size_t>(run.group)].height,
                      GL_READ_ONLY);
    cells_.bind_texture("points", set.views.points);
    cells_.bind_texture("slopes", set.views.slopes);
    cells_.bind_texture("cell_links", set.views.cell_links);
    cells_.bind_texture("blocks", set.views.blocks);
    cells_.bind("Objects", set.object_buffer);
    cells_.bind("Cells", set.cells);
    cells_.set("first_slot", set.first_slot);
    cells_.set("first_block", run.first_block);
    cells_.set("end_block", run.end_block);
    cells_.dispatch_items(run.end_block - run.first_block, 1);
  }
  wait_for_writes();
}

void ReposePass::set_links(const SceneBuffers& scene, const ReposeBuffers& set) {
  links_.use();
  links_.bind_texture("around", set.views.around);
  links_.bind_texture("points", set.views.points);
  links_.bind_texture("slopes", set.views.slopes);
  links_.bind_texture("cell_links", set.views.cell_links);
  links_.bind_texture("cells", set.views.cells);
  links_.bind("Limits", set.limits);
  links_.set("slope_at_rest", limits_.slope);
  links_.set("cohesion", limits_.cohesion);
  links_.set("first_block", 0);
  links_.set("end_block", set.block_count);
  links_.dispatch_items(set.block_count, 1);
  ends_.use();
  ends_.bind_texture("positions", scene.views.positions);
  ends_.bind_texture("triangles", scene.views.triangles);
  ends_.bind_texture("blocks", set.views.blocks);
  ends_.bind_texture("points", set.views.points);
  ends_.bind_texture("slopes", set.views.slopes);
  ends_.bind_texture("cells", set.views.cells);
  ends_.bind_texture("ends", set.views.ends);
  ends_.bind("Objects", set.object_buffer);
  ends_.bind("EndLimits", set.end_limits);
  ends_.set("slope_at_rest", limits_.slope);
  ends_.set("cohesion", limits_.cohesion);
  ends_.set("end_count", set.end_count);
  ends_.set("first_slot", set.first_slot);
  ends_.dispatch_items(set.end_count, 64);
  wait_for_writes();
}

/// For shaders that run over all blocks of the step.
void ReposePass::bind_touched(gpu::Program& program, const ReposeBuffers& set) const {
  program.bind_texture("lists", set.views.lists);
  program.bind("Heads", set.heads);
  program.set("list_begin", kTouched * set.block_count);
  program.set("head", touched_head());
}

/// For shaders that add to lists.
void ReposePass::bind_lists(gpu::Program& program, const ReposeBuffers& set) const {
  program.bind("Heads", set.heads);
  program.bind("BlockStates", set.block_states);
  program.bind("Lists", set.lists);
  program.bind_texture("near_begin", set.views.near_begin);
  program.bind_texture("near", set.views.near);
  program.set("step_number", step_);
}

/// For shaders that work on the window of a block.
void ReposePass::bind_window(gpu::Program& program, const ReposeBuffers& set) const {
  bind_lists(program, set);
  bind_links(program, set);
  program.bind_texture("lists", set.views.lists);
  program.set("touched_begin", kTouched * set.block_count);
  program.set("touched_head", touched_head());
}

void ReposePass::bind_links(gpu::Program& program, const ReposeBuffers& set) {
  program.bind_texture("around", set.views.around);
  program.bind_texture("cells", set.views.cells);
  program.bind_texture("limits", set.views.limits);
  program.bind_texture("first_end", set.views.first_end);
  program.bind_texture("ends", set.views.ends);
  program.bind_texture("end_limits", set.views.end_limits);
}

/// Sets the number of the sweep within the step, its list and that of the next sweep.
void ReposePass::begin_sweep(gpu::Program& program, const ReposeBuffers& set, int32_t number,
                             SweepLists lists) const {
  program.set("sweep", first_sweep_ + static_cast<uint32_t>(number));
  program.set("head", number);
  program.set("list_begin", lists.own * set.block_count);
  program.set("next_begin", lists.next * set.block_count);
}

void ReposePass::choose(const ReposeBuffers& set) {
  choose_.use();
  bind_lists(choose_, set);
  bind_links(choose_, set);
  choose_.set("sweep", first_sweep_);
  choose_.set("head", 0);
  choose_.set("next_begin", 0);
  choose_.set("touched_begin", kTouched * set.block_count);
  choose_.set("touched_head", touched_head());
  choose_.set("rounds_begin", kFirstRounds * set.block_count);
  choose_.set("rounds_head", first_rounds_head());
  choose_.set("first_block", 0);
  choose_.set("end_block", set.block_count);
  choose_.dispatch_items(set.block_count, 1);
  wait_for_writes();
}

void ReposePass::lower_bounds(const ReposeBuffers& set) {
  bounds_.use();
  bind_window(bounds_, set);
  for (int32_t i = 0; i < kBoundSweeps; ++i) {
    const auto before = static_cast<size_t>(i % 2);
    begin_sweep(bounds_, set, i, {i % 2, 1 - i % 2});
    bounds_.bind_texture("bounds_before", set.bounds.view[before]);
    bounds_.bind("Bounds", set.bounds.buffer[1 - before]);
    bounds_.dispatch_indirect(set.heads, head_offset(i));
    wait_for_writes();
  }
  cut_.use();
  bind_touched(cut_, set);
  bind_lists(cut_, set);
  cut_.bind_texture("cells", set.views.cells);
  cut_.bind_texture("bounds", set.bounds.view[kBoundSweeps % 2]);
  cut_.bind("Moved", set.moved.buffer[0]);
  cut_.bind("OtherMoved", set.moved.buffer[1]);
  cut_.set("rounds_begin", kFirstRounds * set.block_count);
  cut_.set("rounds_head", first_rounds_head());
  cut_.dispatch_indirect(set.heads, head_offset(touched_head()));
  wait_for_writes();
}

void ReposePass::run_rounds(const ReposeBuffers& set) {
  rounds_.use();
  bind_window(rounds_, set);
  for (int32_t i = 0; i < round_sweeps_; ++i) {
    const auto before = static_cast<size_t>(i % 2);
    const int32_t head = first_rounds_head() + i;
    begin_sweep(rounds_, set, head, {i == 0 ? kFirstRounds : 1 - i % 2, i % 2});
    rounds_.bind_texture("moved_before", set.moved.view[before]);
    rounds_.bind_texture("flows_before", set.flows.view[before]);
    rounds_.bind_texture("end_flows_before", set.end_flows.view[before]);
    rounds_.bind("Moved", set.moved.buffer[1 - before]);
    rounds_.bind("Flows", set.flows.buffer[1 - before]);
    rounds_.bind("EndFlows", set.end_flows.buffer[1 - before]);
    rounds_.set("first_round", i * shared::kReposeRounds);
    rounds_.set("round_across", i);
    rounds_.dispatch_indirect(set.heads, head_offset(head));
    wait_for_writes();
  }
}

void ReposePass::write(SceneBuffers& scene, const ReposeBuffers& set, float dt) {
  const int64_t touched = head_offset(touched_head());
  for (const ReposeBuffers::Run& run : set.runs) {
    write_.use();
    bind_touched(write_, set);
    write_.bind_image("height_map", scene.groups[static_cast<size_t>(run.group)].height,
                      GL_READ_WRITE);
    write_.bind_texture("points", set.views.points);
    write_.bind_texture("slopes", set.views.slopes);
    write_.bind_texture("cells", set.views.cells);
    write_.bind_texture("blocks", set.views.blocks);
    write_.bind_texture("moved_last", set.moved.view[static_cast<size_t>(round_sweeps_ % 2)]);
    write_.bind("Objects", set.object_buffer);
    write_.bind("Lost", set.lost);
    write_.set("walls_keep", std::exp2(-dt / shared::kWallHalfLife));
    write_.set("first_slot", set.first_slot);
    write_.set("first_block", run.first_block);
    write_.set("end_block", run.end_block);
    write_.dispatch_indirect(set.heads, touched);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT |
                  GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT |
                  GL_PIXEL_BUFFER_BARRIER_BIT);
  reset_.use();
  bind_touched(reset_, set);
  reset_.bind("Moved", set.moved.buffer[0]);
  reset_.bind("OtherMoved", set.moved.buffer[1]);
  reset_.bind("Flows", set.flows.buffer[0]);
  reset_.bind("OtherFlows", set.flows.buffer[1]);
  reset_.bind("Bounds", set.bounds.buffer[0]);
  reset_.bind("OtherBounds", set.bounds.buffer[1]);
  reset_.dispatch_indirect(set.heads, touched);
  sums_.use();
  sums_.set("first_slot", set.first_slot);
  sums_.bind("FirstBlocks", set.first_blocks);
  sums_.bind("Lost", set.lost);
  sums_.bind("Sums", scene.sums);
  sums_.dispatch(set.end_slot - set.first_slot);
  for (const TexelBatch& batch : scene.batches) {
    groups_.use();
    groups_.bind_image("height_map", scene.groups[static_cast<size_t>(batch.group)].height,
                       GL_READ_ONLY);
    groups_.bind_texture("places", batch.views.places);
    groups_.set("texel_count", batch.count);
    groups_.bind("GroupStates", batch.group_states);
    groups_.dispatch_items(batch.count, 64);
  }
  wait_for_writes();
}

}  // namespace snowbough::snow::gl
