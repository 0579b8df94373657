#include "snow/step/gl/repose_buffers.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <set>
#include <stdexcept>
#include <string>

#include "base/parallel_for.h"
#include "shaders/lib/texel_repose.h"
#include "snow/repose/links.h"

namespace snowbough::snow::gl {
namespace {

using shared::kNowhere;
constexpr int32_t kBlock = shared::kReposeBlock;
constexpr int32_t kCells = shared::kReposeCells;
/// Largest array per cell.
constexpr int64_t kBytesACell = 16;

/// A receiver's blocks and links, numbered from 0.
struct ReceiverTables {
  float unit = 1.0f;
  uint32_t blocks_a_side = 0;
  /// Row by row: the number of each block, kNowhere for one without texels.
  std::vector<uint32_t> numbers;
  std::vector<shared::ReposeBlock> blocks;
  std::vector<uint32_t> around;
  std::vector<uint32_t> near_begin{0};
  std::vector<uint32_t> near;
  std::vector<uint32_t> cell_links;
  std::vector<uint32_t> first_end;
  std::vector<shared::ReposeEnd> ends;
};

/// See ReposeSurface::unit; of the rest pose, so that it stays the same.
float unit_of(const SceneObject& object, const std::vector<glm::vec3>& positions) {
  const std::vector<int32_t>& corners = object.description.topology.triangles;
  double area = 0.0;
  for (size_t t = 0; t + 2 < corners.size(); t += 3) {
    const auto at = [&](size_t k) {
      return glm::dvec3(positions[static_cast<size_t>(corners[t + k])]);
    };
    area += 0.5 * glm::length(glm::cross(at(1) - at(0), at(2) - at(0)));
  }
  int exponent = 0;
  const auto texels = static_cast<double>(std::max<size_t>(1, object.table->texel.size()));
  std::frexp(std::max(area / texels, 1e-18), &exponent);
  return std::ldexp(1.0f / shared::kUnitsAMetre, exponent);
}

class TableBuilder {
 public:
  explicit TableBuilder(const SceneObject& object)
      : object_(object),
        resolution_(object.table->resolution),
        side_((resolution_ + kBlock - 1) / kBlock) {}

  ReceiverTables build() {
    const std::vector<glm::vec3>& rest = object_.description.rest;
    const std::vector<glm::vec3>& pose = rest.empty() ? object_.positions : rest;
    links_ = find_repose_links(object_.description.topology, *object_.table, pose);
    tables_.unit = unit_of(object_, pose);
    tables_.blocks_a_side = static_cast<uint32_t>(side_);
    number_blocks();
    find_around();
    add_cells();
    add_ends();
    find_near();
    return std::move(tables_);
  }

 private:
  uint32_t number_of(int32_t column, int32_t row) const {
    if (column < 0 || row < 0 || column >= side_ || row >= side_) return kNowhere;
    return tables_.numbers[static_cast<size_t>(row * side_ + column)];
  }
  uint32_t cell_of(int32_t texel) const {
    const int32_t place = object_.table->texel[static_cast<size_t>(texel)];
    const int32_t column = place % resolution_;
    const int32_t row = place / resolution_;
    return number_of(column / kBlock, row / kBlock) * static_cast<uint32_t>(kCells) +
           static_cast<uint32_t>(row % kBlock * kBlock + column % kBlock);
  }

  void number_blocks() {
    tables_.numbers.assign(static_cast<size_t>(side_) * static_cast<size_t>(side_), kNowhere);
    for (const int32_t place : object_.table->texel) {
      tables_.numbers[static_cast<size_t>(place / resolution_ / kBlock * side_ +
                                          place % resolution_ / kBlock)] = 0;
    }
    for (int32_t b = 0; b < side_ * side_; ++b) {
      uint32_t& number = tables_.numbers[static_cast<size_t>(b)];
      if (number == kNowhere) continue;
      number = static_cast<uint32_t>(tables_.blocks.size());
      tables_.blocks.push_back({static_cast<uint32_t>(b % side_ * kBlock),
                                static_cast<uint32_t>(b / side_ * kBlock), 0, 0});
    }
  }

  void find_around() {
    for (const shared::ReposeBlock& block : tables_.blocks) {
      for (int32_t k = 0; k < 9; ++k) {
        tables_.around.push_back(number_of(static_cast<int32_t>(block.column) / kBlock + k % 3 - 1,
                                           static_cast<int32_t>(block.row) / kBlock + k / 3 - 1));
      }
    }
  }

  void add_cells() {
    const size_t cells = tables_.blocks.size() * static_cast<size_t>(kCells);
    tables_.cell_links.assign(cells, static_cast<uint32_t>(shared::kLinks) << 4);
    tables_.first_end.assign(cells, kNowhere);
    const std::vector<int32_t>& places = object_.table->texel;
    for (size_t i = 0; i < places.size(); ++i) {
      const auto own = static_cast<size_t>(links_.cell_of(places[i]));
      tables_.cell_links[cell_of(static_cast<int32_t>(i))] |= links_.forward[own] & 15u;
    }
  }

  static uint32_t links_at(const ReposeLinks::End& end) {
    return static_cast<uint32_t>(std::max(end.links, static_cast<int32_t>(shared::kLinks)));
  }

  void add_ends() {
    for (const ReposeLinks::End& end : links_.ends) {
      uint32_t& links = tables_.cell_links[cell_of(end.texel)];
      links = (links & 15u) | links_at(end) << 4;
    }
    const auto part = [&](uint32_t cell) {
      return 1.0f / static_cast<float>(tables_.cell_links[cell] >> 4);
    };
    for (const ReposeLinks::End& end : links_.ends) {
      const auto link = static_cast<size_t>(end.link);
      const bool is_rim = link >= links_.across.size();
      const ReposeLinks::Point& at =
          is_rim ? links_.rims[link - links_.across.size()].point : links_.across[link].seam;
      shared::ReposeEnd own{};
      own.cell = cell_of(end.texel);
      own.other =
          is_rim ? kNowhere : cell_of(end.sign < 0 ? links_.across[link].b : links_.across[link].a);
      own.triangle = static_cast<uint32_t>(at.triangle);
      own.weight_b = at.weights.x;
      own.weight_c = at.weights.y;
      own.part = part(own.cell);
      own.other_part = is_rim ? 0.0f : part(own.other);
      uint32_t& first = tables_.first_end[own.cell];
      if (first == kNowhere) first = static_cast<uint32_t>(tables_.ends.size());
      tables_.ends.push_back(own);
    }
  }

  /// The blocks around each block, and around those linked with it across seams.
  void find_near() {
    std::vector<std::set<uint32_t>> near(tables_.blocks.size());
    const auto add_around = [&](size_t block, size_t of) {
      for (size_t k = 0; k < 9; ++k) {
        const uint32_t other = tables_.around[9 * of + k];
        if (other != kNowhere) near[block].insert(other);
      }
    };
    for (size_t b = 0; b < near.size(); ++b) add_around(b, b);
    for (const shared::ReposeEnd& end : tables_.ends) {
      if (end.other != kNowhere) add_around(end.cell / kCells, end.other / kCells);
    }
    for (const std::set<uint32_t>& own : near) {
      tables_.near.insert(tables_.near.end(), own.begin(), own.end());
      tables_.near_begin.push_back(static_cast<uint32_t>(tables_.near.size()));
    }
  }

  const SceneObject& object_;
  int32_t resolution_;
  int32_t side_;
  ReposeLinks links_;
  ReceiverTables tables_;
};

/// Appends a receiver's tables to those of the receivers before it.
struct TableSet {
  std::vector<shared::ReposeObject> objects;
  std::vector<uint32_t> first_blocks{0};
  std::vector<ReposeBuffers::Run> runs;
  ReceiverTables all;

  size_t cells_with(const ReceiverTables& more) const {
    return (all.blocks.size() + more.blocks.size()) * static_cast<size_t>(kCells);
  }

  void add(ReceiverTables&& own, uint32_t slot, uint32_t layer, int32_t group,
           uint32_t first_triangle) {
    const auto first_block = static_cast<uint32_t>(all.blocks.size());
    const uint32_t first_cell = first_block * static_cast<uint32_t>(kCells);
    const auto first_end = static_cast<uint32_t>(all.ends.size());
    const auto append = [](std::vector<uint32_t>& to, const std::vector<uint32_t>& from,
                           uint32_t shift) {
      for (const uint32_t value : from) to.push_back(value == kNowhere ? kNowhere : value + shift);
    };
    objects.push_back({glm::vec4(0.0f, 0.0f, 0.0f, own.unit),
                       static_cast<uint32_t>(all.numbers.size()), own.blocks_a_side, 1,
                       first_block});
    append(all.numbers, own.numbers, first_block);
    append(all.around, own.around, first_block);
    const auto first_near = static_cast<uint32_t>(all.near.size());
    append(all.near, own.near, first_block);
    own.near_begin.erase(own.near_begin.begin());
    append(all.near_begin, own.near_begin, first_near);
    append(all.cell_links, own.cell_links, 0);
    append(all.first_end, own.first_end, first_end);
    for (shared::ReposeEnd& end : own.ends) {
      end.cell += first_cell;
      if (end.other != kNowhere) end.other += first_cell;
      end.triangle += first_triangle;
      all.ends.push_back(end);
    }
    for (shared::ReposeBlock& block : own.blocks) {
      block.layer = layer;
      block.slot = slot;
      all.blocks.push_back(block);
    }
    const auto end_block = static_cast<int32_t>(all.blocks.size());
    if (runs.empty() || runs.back().group != group) {
      runs.push_back({group, static_cast<int32_t>(first_block), end_block});
    }
    runs.back().end_block = end_block;
    first_blocks.push_back(static_cast<uint32_t>(end_block));
  }
};

TwoCopies two_copies(int64_t count, int64_t bytes, GLenum format) {
  TwoCopies copies;
  for (size_t k = 0; k < 2; ++k) {
    copies.buffer[k] = gpu::Buffer(count * bytes);
    copies.view[k] = gpu::BufferTexture(copies.buffer[k], format);
  }
  return copies;
}

ReposeBuffers upload(TableSet&& set, int32_t first_slot) {
  ReposeBuffers to;
  // The ends of a cell end at one of another cell.
  to.end_count = static_cast<int32_t>(set.all.ends.size());
  set.all.ends.push_back({kNowhere, kNowhere, 0, 0.0f, 0.0f, 0.0f, 0.0f, 0});
  to.first_slot = first_slot;
  to.end_slot = first_slot + static_cast<int32_t>(set.objects.size());
  to.block_count = static_cast<int32_t>(set.all.blocks.size());
  to.runs = std::move(set.runs);
  to.objects = std::move(set.objects);
  to.object_buffer = gpu::Buffer(to.objects);
  to.first_blocks = gpu::Buffer(set.first_blocks);
  to.tables = gpu::Buffer(set.all.numbers);
  to.blocks = gpu::Buffer(set.all.blocks);
  to.around = gpu::Buffer(set.all.around);
  to.near_begin = gpu::Buffer(set.all.near_begin);
  to.near = gpu::Buffer(set.all.near);
  to.cell_links = gpu::Buffer(set.all.cell_links);
  to.first_end = gpu::Buffer(set.all.first_end);
  to.ends = gpu::Buffer(set.all.ends);
  const int64_t cells = int64_t{kCells} * to.block_count;
  const int64_t ends = to.end_count + 1;
  for (gpu::Buffer* buffer : {&to.points, &to.slopes, &to.limits, &to.cells}) {
    *buffer = gpu::Buffer(kBytesACell * cells);
  }
  to.end_limits = gpu::Buffer(16 * ends);
  to.moved = two_copies(cells, 4, GL_R32I);
  to.flows = two_copies(cells, 16, GL_RGBA32F);
  to.end_flows = two_copies(ends, 4, GL_R32F);
  const std::vector<float> unbounded(static_cast<size_t>(cells), shared::kUnbounded);
  to.bounds = two_copies(cells, 4, GL_R32F);
  for (gpu::Buffer& bounds : to.bounds.buffer) bounds.write(0, 4 * cells, unbounded.data());
  to.lost = gpu::Buffer(int64_t{8} * to.block_count);
  to.block_states =
      gpu::Buffer(static_cast<int64_t>(sizeof(shared::ReposeBlockState)) * to.block_count);
  to.lists = gpu::Buffer(int64_t{4} * 4 * to.block_count);
  ReposeBuffers::Views& views = to.views;
  const auto view = [](gpu::BufferTexture& of, const gpu::Buffer& buffer, GLenum format) {
    of = gpu::BufferTexture(buffer, format);
  };
  view(views.blocks, to.blocks, GL_RGBA32UI);
  view(views.around, to.around, GL_R32UI);
  view(views.near_begin, to.near_begin, GL_R32UI);
  view(views.near, to.near, GL_R32UI);
  view(views.cell_links, to.cell_links, GL_R32UI);
  view(views.first_end, to.first_end, GL_R32UI);
  view(views.ends, to.ends, GL_RGBA32UI);
  view(views.points, to.points, GL_RGBA32F);
  view(views.slopes, to.slopes, GL_RGBA32F);
  view(views.limits, to.limits, GL_RGBA32F);
  view(views.end_limits, to.end_limits, GL_RGBA32F);
  view(views.cells, to.cells, GL_RGBA32F);
  view(views.lists, to.lists, GL_R32UI);
  return to;
}

}  // namespace

std::vector<ReposeBuffers> build_repose_buffers(const std::vector<const SceneObject*>& objects,
                                                const SceneBuffers& scene,
                                                const gpu::GpuInfo& info) {
  const auto most_cells = static_cast<size_t>(info.max_storage_buffer_bytes / kBytesACell);
  const std::vector<size_t> numbers = objects_by_slot(scene.layout.plan);
  size_t receivers = 0;
  while (receivers < objects.size() && objects[numbers[receivers]]->description.receive)
    ++receivers;
  std::vector<ReceiverTables> tables(receivers);
  base::for_each_item(receivers, 1, [&](size_t slot) {
    tables[slot] = TableBuilder(*objects[numbers[slot]]).build();
  });
  std::vector<ReposeBuffers> result;
  TableSet set;
  size_t first_slot = 0;
  const auto finish = [&](size_t slot) {
    if (set.objects.empty()) return;
    result.push_back(upload(std::move(set), static_cast<int32_t>(first_slot)));
    set = {};
    first_slot = slot;
  };
  bool two_sided = false;
  for (size_t slot = 0; slot < receivers; ++slot) {
    const SceneObject& object = *objects[numbers[slot]];
    const size_t own = tables[slot].blocks.size() * static_cast<size_t>(kCells);
    if (own > most_cells) {
      throw std::runtime_error("repose on the map of '" + object.description.name + "' needs " +
                               std::to_string(static_cast<int64_t>(own) * kBytesACell >> 20) +
                               " MiB, the limit of the driver (" + info.renderer + ") is " +
                               std::to_string(info.max_storage_buffer_bytes >> 20) +
                               " MiB: use a smaller map, a repose of 90 degrees or the engine CPU");
    }
    if (set.cells_with(tables[slot]) > most_cells) finish(slot);
    const int32_t group = scene.layout.plan.group[numbers[slot]];
    const auto layer =
        static_cast<int32_t>(slot) - scene.groups[static_cast<size_t>(group)].first_slot;
    set.add(std::move(tables[slot]), static_cast<uint32_t>(slot), static_cast<uint32_t>(layer),
            group, static_cast<uint32_t>(scene.layout.first_triangle[numbers[slot]]));
    two_sided = two_sided || std::any_of(object.two_sided.begin(), object.two_sided.end(),
                                         [](uint8_t both) { return both != 0; });
  }
  finish(receivers);
  for (ReposeBuffers& buffers : result) buffers.has_two_sided = two_sided;
  return result;
}

}  // namespace snowbough::snow::gl
