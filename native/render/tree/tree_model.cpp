#include "render/tree/tree_model.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "render/draw/image_texture.h"
#include "render/tree/bark_uvs.h"
#include "render/tree/leaf_triangles.h"

namespace snowbough::render {
namespace {

constexpr float kTurn = 6.2831853f;
/// Upper bound of the distance between a limb's surface and its four sides, in radii: that of a
/// circle, 1 - 1 / sqrt(2), and the growth of shaders/lib/thin_limbs.h.
constexpr float kRoundness = 0.5f;

template <typename Element>
Arena arena_of(int64_t most_bytes, int64_t elements = 1) {
  return {elements * static_cast<int64_t>(sizeof(Element)), most_bytes};
}

}  // namespace

TreeStore::TreeStore(int64_t most_bytes, int32_t its_number)
    : number(its_number),
      vertices(arena_of<shared::TreeVertex>(most_bytes)),
      sections(arena_of<shared::TreeSection>(most_bytes)),
      edges(arena_of<shared::TreeEdge>(most_bytes)),
      patches(arena_of<shared::TreePatch>(most_bytes)),
      vertex_snow(arena_of<glm::vec2>(most_bytes)),
      bark_uvs(arena_of<shared::BarkUv>(most_bytes)),
      leaf_triangles(arena_of<shared::LeafVertex>(most_bytes, 3)) {}

bool TreeStore::has_room(const TreePatches& tree) const {
  return vertices.has_room(tree.vertices.size()) && sections.has_room(tree.sections.size()) &&
         edges.has_room(tree.edges.size()) && patches.has_room(tree.patches.size()) &&
         vertex_snow.has_room(tree.vertex_snow.size()) && bark_uvs.has_room(tree.patches.size()) &&
         leaf_triangles.has_room(leaf_triangles.most() / 2);
}

TreeModel::TreeModel(std::shared_ptr<TreeStore> its_store, const TreePatches& tree,
                     const TreeLook& its_look, int32_t its_number)
    : store(std::move(its_store)),
      number(its_number),
      vertex_count(static_cast<int32_t>(tree.vertices.size())),
      edge_count(static_cast<int32_t>(tree.edges.size())),
      section_count(static_cast<int32_t>(tree.sections.size())),
      vertex_snow_count(static_cast<int32_t>(tree.vertex_snow.size())),
      quads(tree.quads),
      order(tree.order),
      used_vertices(tree.used_vertices),
      used_edges(tree.used_edges),
      bone_count(tree.bone_count),
      branch_levels(tree.branch_levels),
      has_snow_uvs(tree.has_snow_uvs),
      largest_area(tree.largest_area),
      look(its_look),
      rest(tree.bone_count) {
  if (!store->has_room(tree)) {
    throw std::invalid_argument("add_tree: the tree has " + std::to_string(tree.patches.size()) +
                                " quads, more than a buffer of this driver holds");
  }
  for (const shared::TreePatch& patch : tree.patches) {
    patch_edges.push_back(patch.edges);
    bulge = std::max(bulge, patch.rest[1].w);
  }
  float widest = 0.0f;
  for (const shared::TreeVertex& vertex : tree.vertices) {
    widest = std::max(widest, vertex.normal.w / kTurn);
    for (int k = 0; k < 4; ++k) {
      if (vertex.weights[k] > 0.0f) rest.add(vertex.bones[k], glm::vec3(vertex.position));
    }
  }
  bulge += kRoundness * widest;
  first = {store->vertices.add(tree.vertices), store->edges.add(tree.edges),
           store->patches.add(tree.patches), store->sections.add(tree.sections)};
  first_vertex_snow = store->vertex_snow.add(tree.vertex_snow);
}

TreeModel::~TreeModel() {
  store->vertices.remove(first.x, static_cast<size_t>(vertex_count));
  store->edges.remove(first.y, static_cast<size_t>(edge_count));
  store->patches.remove(first.z, quads.size());
  store->sections.remove(first.w, static_cast<size_t>(section_count));
  store->vertex_snow.remove(first_vertex_snow, static_cast<size_t>(vertex_snow_count));
  if (bark_images) store->bark_uvs.remove(first_bark_uv, quads.size());
  remove_leaves();
}

void TreeModel::set_bark(const BarkSource& bark) {
  const std::vector<shared::BarkUv> uvs = bark_uvs(bark, quads);
  gpu::Texture layers = material_layers(bark.materials, "set_bark");
  if (!bark_images) {
    first_bark_uv = store->bark_uvs.add(uvs);
  } else {
    store->bark_uvs.write(first_bark_uv, uvs.data(), uvs.size());
  }
  bark_images.emplace(std::move(layers));
}

void TreeModel::remove_leaves() {
  for (const LeafPart& part : leaves) {
    store->leaf_triangles.remove(part.first_triangle, part.drop_points.size());
  }
  leaves.clear();
}

void TreeModel::set_leaves(const LeafSource& source) {
  const std::vector<LeafTriangles> parts = leaf_triangles(source, bone_count);
  std::vector<LeafPart> made;
  for (size_t m = 0; m < parts.size(); ++m) {
    const Material& material = source.materials[m];
    if (parts[m].drop_points.empty()) continue;
    made.push_back(
        {0, parts[m].drop_points, material.color, image_texture(material.image, "leaves")});
  }
  remove_leaves();
  for (size_t m = 0, part = 0; m < parts.size(); ++m) {
    const size_t count = parts[m].drop_points.size();
    if (count == 0) continue;
    if (!store->leaf_triangles.has_room(count)) {
      throw std::invalid_argument("leaves: the tree has " + std::to_string(source.bone.size()) +
                                  " triangles, more than a buffer of this driver holds");
    }
    made[part++].first_triangle = store->leaf_triangles.add(parts[m].vertices.data(), count);
  }
  leaves = std::move(made);
  for (size_t i = 0; i < source.positions.size(); ++i) {
    rest.add(source.bone[i / 3], source.positions[i]);
  }
}

shared::TreeInstance TreeModel::instance() const {
  shared::TreeInstance made{};
  made.base = first;
  made.lists = {first_vertex_snow, first_bark_uv, 0, 0};
  made.bark_dark = glm::vec4(look.bark_dark, largest_area);
  made.bark_light = glm::vec4(look.bark_light, static_cast<float>(branch_levels));
  return made;
}

}  // namespace snowbough::render
