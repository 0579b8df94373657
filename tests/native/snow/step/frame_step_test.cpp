// The order in which a step calls the passes of any engine.
#include "snow/step/frame_step.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

namespace snowbough::snow {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Not;

/// Records its calls.
class WritesDown : public Engine {
 public:
  explicit WritesDown(const std::vector<const SceneObject*>& objects)
      : layout_(lay_out_scene(objects, 8)) {}

  std::vector<std::string> calls;
  std::vector<std::vector<TriangleRange>> drawn;
  float full_gain = 0.0f;

  EngineKind kind() const override { return EngineKind::kCpu; }
  std::string driver() const override { return "none"; }
  int64_t free_memory() override { return 0; }
  MemoryEstimate memory(const std::vector<const SceneObject*>&, int32_t) const override {
    return {};
  }
  void run(const std::function<void()>& work) override { work(); }
  void build_scene(const std::vector<const SceneObject*>&) override { calls.push_back("build"); }
  void set_positions(size_t object, const std::vector<glm::vec3>&) override {
    calls.push_back("positions " + std::to_string(object));
  }
  void set_up_triangles(const shared::ProjectionFrame&) override { calls.push_back("triangles"); }
  void choose_texels() override { calls.push_back("choose"); }
  void open_statistics() override { calls.push_back("open"); }
  void evaluate_texels() override { calls.push_back("evaluate"); }
  void render_occlusion(const Tile&, const std::vector<TriangleRange>& ranges) override {
    calls.push_back("occlusion");
    drawn.push_back(ranges);
  }
  void count_back_faces(const Tile&) override { calls.push_back("back faces"); }
  void gather_deposit(const Tile&, bool is_first) override {
    calls.push_back(is_first ? "first deposit" : "deposit");
  }
  void apply_stability(const StabilitySettings&, float gain, float) override {
    calls.push_back("stability");
    full_gain = gain;
  }
  void move_snow(const std::function<void(std::vector<MovingMap>&)>&) override {
    calls.push_back("movement");
  }
  void close_statistics(float) override { calls.push_back("close"); }
  void read_height(size_t, std::vector<float>&) override {}
  void write_height(size_t, const std::vector<float>&) override {}
  shared::ObjectSums read_sums(size_t) override { return {}; }
  void write_sums(size_t, const shared::ObjectSums&) override {}
  const SceneLayout& layout() const override { return layout_; }

 private:
  SceneLayout layout_;
};

/// A square metre at x = `left` that faces up.
SceneObject square_at(const std::string& name, float left, bool receive, bool occlude) {
  SceneObject object;
  object.description.name = name;
  object.description.receive = receive;
  object.description.occlude = occlude;
  MapTopology& topology = object.description.topology;
  topology.triangles = {0, 1, 2, 0, 2, 3};
  topology.corner_uv = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
  topology.vertex_count = 4;
  topology.resolution = 64;
  object.positions = {{left, 0, 0}, {left + 1, 0, 0}, {left + 1, 1, 0}, {left, 1, 0}};
  for (const glm::vec3& point : object.positions) object.bounds.include(glm::dvec3(point));
  return object;
}

FrameStep step_of(double depth, int32_t tile_size = 2048) {
  FrameStep step;
  step.fall.pixel_size = 0.1;
  step.fall.depth = depth;
  step.dt = 0.04;
  step.tile_size = tile_size;
  return step;
}

void step_on(Engine& engine, const std::vector<SceneObject*>& objects, const FrameStep& step) {
  Movement movement;
  movement.lay_out({objects.begin(), objects.end()});
  run_step(engine, movement, objects, step);
}

TEST(FrameStep, CallsThePassesInTheirOrder) {
  SceneObject ground = square_at("ground", 0, true, true);
  WritesDown engine({&ground});
  step_on(engine, {&ground}, step_of(0.01));
  EXPECT_THAT(engine.calls, ElementsAre("positions 0", "triangles", "open", "choose", "occlusion",
                                        "back faces", "first deposit", "stability", "close"));
}

TEST(FrameStep, ReadsHeightsBackOnlyIfSnowMoves) {
  SceneObject ground = square_at("ground", 0, true, true);
  WritesDown engine({&ground});
  FrameStep step = step_of(0.01);
  step.movement.repose.angle = 1.1;
  step_on(engine, {&ground}, step);
  EXPECT_THAT(engine.calls, Contains("movement"));
  engine.calls.clear();
  step.dt = 0.0;
  step_on(engine, {&ground}, step);
  EXPECT_THAT(engine.calls, Not(Contains("movement")));
}

TEST(FrameStep, UploadsOnlyPositionsThatChanged) {
  SceneObject ground = square_at("ground", 0, true, true);
  SceneObject roof = square_at("roof", 1, false, true);
  WritesDown engine({&ground, &roof});
  step_on(engine, {&ground, &roof}, step_of(0.01));
  EXPECT_FALSE(ground.moved || roof.moved);
  roof.moved = true;
  engine.calls.clear();
  step_on(engine, {&ground, &roof}, step_of(0.01));
  EXPECT_EQ(engine.calls[0], "positions 1");
  EXPECT_EQ(engine.calls[1], "triangles");
}

TEST(FrameStep, RendersNoOcclusionWithoutSnowfall) {
  SceneObject ground = square_at("ground", 0, true, true);
  WritesDown engine({&ground});
  step_on(engine, {&ground}, step_of(0.0));
  EXPECT_THAT(engine.calls, ElementsAre("positions 0", "triangles", "open", "choose", "evaluate",
                                        "stability", "close"));
}

TEST(FrameStep, BeginsTheDepositWithItsFirstTile) {
  SceneObject ground = square_at("ground", 0, true, true);
  WritesDown engine({&ground});
  step_on(engine, {&ground}, step_of(0.01, 8));  // ten pixels and some a side
  EXPECT_EQ(std::count(engine.calls.begin(), engine.calls.end(), "first deposit"), 1);
  EXPECT_EQ(std::count(engine.calls.begin(), engine.calls.end(), "deposit"), 3);
}

TEST(FrameStep, DrawsAdjacentObjectsTogetherAndOnlyOccludersOfTheTile) {
  SceneObject ghost = square_at("a ghost", 0, false, false);
  SceneObject ground = square_at("b ground", 0, true, true);
  SceneObject roof = square_at("c roof", 0, false, true);
  SceneObject far_away = square_at("d far away", 1000, false, true);
  const std::vector<SceneObject*> objects{&ghost, &ground, &roof, &far_away};
  WritesDown engine({&ghost, &ground, &roof, &far_away});
  step_on(engine, objects, step_of(0.01));
  ASSERT_EQ(engine.drawn.size(), 1u);
  ASSERT_EQ(engine.drawn[0].size(), 1u);
  EXPECT_EQ(engine.drawn[0][0].first, 2);
  EXPECT_EQ(engine.drawn[0][0].count, 4);
}

TEST(FrameStep, ReducedDensityKeepsTheMeanDepth) {
  SceneObject ground = square_at("ground", 0, true, true);
  WritesDown engine({&ground});
  FrameStep step = step_of(0.01);
  step_on(engine, {&ground}, step);
  EXPECT_FLOAT_EQ(engine.full_gain, 0.01f);
  step.fall.noise_density = 0.25;
  step_on(engine, {&ground}, step);
  EXPECT_FLOAT_EQ(engine.full_gain, 0.04f);
}

}  // namespace
}  // namespace snowbough::snow
