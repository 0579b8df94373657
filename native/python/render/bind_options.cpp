#include <pybind11/stl.h>

#include <optional>

#include "python/choose.h"
#include "python/render/arrays.h"
#include "python/render/bind_parts.h"
#include "render/data/view.h"

namespace snowbough::python {
namespace {

using namespace snowbough::render;

/// Binds a struct of options, whose fields are set by keywords in the constructor or as attributes.
template <typename Options>
class OptionsClass {
 public:
  OptionsClass(py::module_& module, const char* name, const char* doc) : class_(module, name, doc) {
    class_.def(py::init([](const py::kwargs& values) {
      py::object made = py::cast(Options{});
      for (const auto& [key, value] : values) {
        const auto field = py::cast<std::string>(key);
        if (!py::hasattr(made, key)) throw py::type_error("there is no setting '" + field + "'");
        py::setattr(made, key, value);
      }
      return made.cast<Options>();
    }));
  }
  template <typename Value>
  OptionsClass& field(const char* name, Value Options::*member, const char* doc) {
    class_.def_readwrite(name, member, doc);
    return *this;
  }
  OptionsClass& field(const char* name, glm::vec3 Options::*member, const char* doc) {
    class_.def_property(
        name,
        [member](const Options& self) {
          const glm::vec3& v = self.*member;
          return py::make_tuple(v.x, v.y, v.z);
        },
        [member](Options& self, const Vec3& value) { self.*member = to_vec3(value); }, doc);
    return *this;
  }
  py::class_<Options>& python() { return class_; }

 private:
  py::class_<Options> class_;
};

/// A 4 x 4 matrix, row-major as in numpy, or None.
template <typename Options>
void matrix_field(OptionsClass<Options>& to, const char* name,
                  std::optional<glm::mat4> Options::*member, const char* doc) {
  to.python().def_property(
      name,
      [member](const Options& self) -> py::object {
        const std::optional<glm::mat4>& matrix = self.*member;
        if (!matrix) return py::none();
        const glm::mat4 rows = glm::transpose(*matrix);
        return py::array_t<float>({4, 4}, &rows[0][0]);
      },
      [member](Options& self, const py::object& value) {
        (self.*member).reset();
        if (value.is_none()) return;
        const auto rows = py::cast<InputArray<float>>(value);
        require_shape(rows, {4, 4}, "a matrix");
        require_finite(rows, "a matrix");
        self.*member = glm::transpose(elements<glm::mat4>(rows)[0]);
      },
      doc);
}

}  // namespace

void bind_render_options(py::module_& module) {
  OptionsClass<Camera> camera(
      module, "Camera",
      R"(A camera, with fields as keywords: a pinhole, or any camera given by two matrices. Metres,
radians.)");
  camera.field("eye", &Camera::eye, "Position, (3,).")
      .field("target", &Camera::target, "Point in the middle of the picture, (3,).")
      .field("up", &Camera::up, "Up direction of the picture, (3,).")
      .field("field_of_view", &Camera::field_of_view, "Vertical angle, radians.")
      .field("near", &Camera::near, "Metres; 0: from the scene's size.")
      .field("far", &Camera::far, "Metres; 0: from the scene's size.")
      .field("width", &Camera::width, "Pixels.")
      .field("height", &Camera::height, "Pixels.");
  matrix_field(
      camera, "view", &Camera::view,
      R"((4, 4) from world to camera space, as in OpenGL; with `projection` it replaces everything
except the size.)");
  matrix_field(camera, "projection", &Camera::projection,
               "(4, 4) from camera space to clip space, perspective or orthographic.");
  OptionsClass<Snowfall>(module, "Snowfall",
                         "Falling flakes, with fields as keywords. Metres, seconds, radians.")
      .field("rate", &Snowfall::rate, "Depth per second on open level ground; 0: no flakes.")
      .field("direction", &Snowfall::direction, "Fall direction, downwards, (3,).")
      .field("speed", &Snowfall::speed, "Metres per second.")
      .field("flutter", &Snowfall::flutter,
             "Largest angle to the fall direction, radians, 0 to pi / 4.")
      .field("radius", &Snowfall::radius, "Radius of a flake, metres.")
      .field("metre", &Snowfall::metre, "Length of a metre in scene units.")
      .field("shutter", &Snowfall::shutter, "Exposure time, seconds.")
      .field("time", &Snowfall::time, "Time of the picture, seconds.")
      .field("seed", &Snowfall::seed, "The same seed and time give the same flakes.");
  OptionsClass<RenderSettings> settings(module, "RenderSettings",
                                        "Settings of a picture, with fields as keywords.");
  settings
      .field("max_level", &RenderSettings::max_level,
             "Maximum number of parts of an edge, 1 to 64; 1: no tessellation.")
      .field("target_pixels", &RenderSettings::target_pixels, "SCREEN: pixels per part of an edge.")
      .field(
          "min_pixels", &RenderSettings::min_pixels,
          "SCREEN: least width of a limb in pixels: some thinner limbs are dropped, and the others "
          "grow to it. 0: all limbs are drawn as they are.")
      .field("max_distance", &RenderSettings::max_distance,
             "THESIS: distance in metres at which the level reaches 1.")
      .field("max_area", &RenderSettings::max_area,
             "THESIS: area in m2 at which the level is highest; 0: the tree's largest patch.")
      .field("snow_factor", &RenderSettings::snow_factor,
             "THESIS, of snow on trees: m of tf = clamp(max(n.up, 0) * m * A, 1, max).")
      .field("wireframe", &RenderSettings::wireframe,
             "Draws lines and hides those behind the surface.")
      .field("cull_back_faces", &RenderSettings::cull_back_faces, "Omits bark seen from its back.")
      .field("antialias", &RenderSettings::antialias, "Averages 2 x 2 pixels.")
      .field("draft", &RenderSettings::draft,
             "For frames: keeps the previous shadow map if only the camera moved.")
      .field("sun_direction", &RenderSettings::sun_direction, "Direction to the sun, (3,).")
      .field("sun_color", &RenderSettings::sun_color, "Linear light on surfaces that face the sun.")
      .field("sky_color", &RenderSettings::sky_color, "Linear light on surfaces that face up.")
      .field("ground_color", &RenderSettings::ground_color,
             "Linear light on surfaces that face down.")
      .field("snowfall", &RenderSettings::snowfall,
             "Falling flakes, a Snowfall; not in wireframes.")
      .field("shadow_resolution", &RenderSettings::shadow_resolution,
             "Edge of the shadow map in texels; 0: no shadows.");
  settings.python().def_property(
      "background",
      [](const RenderSettings& self) -> py::object {
        if (!self.background) return py::none();
        return py::make_tuple(self.background->x, self.background->y, self.background->z);
      },
      [](RenderSettings& self, const std::optional<Vec3>& value) {
        self.background.reset();
        if (value) self.background = to_vec3(*value);
      },
      "Linear light behind everything, (3,); None: the sky's.");
  settings.python().def_property(
      "metric",
      [](const RenderSettings& self) {
        return self.metric == Metric::kThesis ? "THESIS" : "SCREEN";
      },
      [](RenderSettings& self, const std::string& value) {
        self.metric = choose<Metric>("metric", value,
                                     {{"THESIS", Metric::kThesis}, {"SCREEN", Metric::kScreen}});
      },
      "SCREEN: parts of edges cover target_pixels; THESIS: the thesis's eq. 3.4.1.");
}

}  // namespace snowbough::python
