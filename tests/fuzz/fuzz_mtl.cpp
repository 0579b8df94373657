// Material libraries. No texture outside the pack may be found.
#include "fuzz_input.h"
#include "tree/obj/mtl_reader.h"
#include "tree/obj/texture_files.h"

using namespace snowbough;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const fuzz::ScratchFolder scratch;
  static const bool has_textures = [] {
    for (const char* name : {"secret.png", "pack/textures/bark.png", "pack/model/leaf.JPG",
                             "pack/model/maps/inner/bark_n.tif", "pack/model/twig.png"}) {
      scratch.write(name, "");
    }
    return true;
  }();
  fuzz::require(has_textures, "the textures were not made");
  // Each texture costs a search in some folders.
  constexpr size_t kLongest = 384;
  const std::string_view text(reinterpret_cast<const char*>(data), std::min(size, kLongest));
  scratch.write("pack/model/fuzz.mtl", text);
  const std::string obj = scratch.file("pack/model/fuzz.obj");
  // The first line also serves as the OBJ's name of a library.
  const std::string library(text.substr(0, text.find('\n')));
  std::vector<std::string> warnings;
  const auto materials =
      tree::read_materials(obj, {"fuzz.mtl", library}, {"bark", "leaf", ""}, false, warnings);
  for (const auto& [key, material] : materials) {
    fuzz::require(key == material.name, "a material has another name");
    for (const tree::MaterialTexture* texture :
         {&material.diffuse_texture, &material.alpha_texture, &material.specular_texture,
          &material.normal_texture, &material.bump_texture}) {
      fuzz::require(texture->path.empty() || tree::lies_below(scratch.file("pack"), texture->path),
                    "a texture lies outside the pack");
    }
  }
  return 0;
}
