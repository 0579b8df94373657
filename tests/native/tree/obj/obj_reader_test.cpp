#include "tree/obj/obj_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <sstream>
#include <string>
#include <vector>

#include "tree/obj/obj_fragment.h"
#include "tree/obj/parts.h"

namespace snowbough::tree {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

ObjScene parse(const std::string& text, size_t buffer_size = 1 << 16) {
  std::istringstream stream(text);
  return read_obj(stream, "t.obj", {.buffer_size = buffer_size});
}

std::string error_of(const std::string& text, size_t buffer_size = 1 << 16) {
  try {
    parse(text, buffer_size);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no error";
}

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

/// All data of a scene that splitting the text into pieces could change.
void expect_same(const ObjScene& a, const ObjScene& b, const std::string& when) {
  EXPECT_EQ(a.positions, b.positions) << when;
  EXPECT_EQ(a.uvs, b.uvs) << when;
  EXPECT_EQ(a.normals, b.normals) << when;
  EXPECT_EQ(a.face_begin, b.face_begin) << when;
  EXPECT_EQ(a.corner_vertex, b.corner_vertex) << when;
  EXPECT_EQ(a.corner_uv, b.corner_uv) << when;
  EXPECT_EQ(a.corner_normal, b.corner_normal) << when;
  EXPECT_EQ(a.names, b.names) << when;
  EXPECT_EQ(a.materials, b.materials) << when;
  EXPECT_EQ(a.short_faces, b.short_faces) << when;
  EXPECT_EQ(a.loose_elements, b.loose_elements) << when;
  const auto rows = [](const ObjScene& scene) {
    std::vector<std::array<int32_t, 4>> result;
    for (const FaceRun& run : scene.runs) {
      result.push_back({run.first_face, run.object, run.group, run.material});
    }
    return result;
  };
  EXPECT_EQ(rows(a), rows(b)) << when;
}

TEST(ObjReader, ReadsVerticesAndFaces) {
  const ObjScene scene = parse(kTriangle + "f 1 2 3\n");
  EXPECT_EQ(scene.positions[1], glm::vec3(1, 0, 0));
  EXPECT_THAT(scene.corner_vertex, ElementsAre(0, 1, 2));
  EXPECT_THAT(scene.face_begin, ElementsAre(0, 3));
}

TEST(ObjReader, ReadsNormalsOfCorners) {
  const ObjScene scene =
      parse(kTriangle + "vn 0 0 1\nvn 0 2 0\nf 1//2 2 3//-2\nf 1 2 3\nf 1//1 2//1\n");
  EXPECT_THAT(scene.normals, ElementsAre(glm::vec3(0, 0, 1), glm::vec3(0, 2, 0)));
  EXPECT_THAT(scene.corner_normal, ElementsAre(1, -1, 0, -1, -1, -1));
}

TEST(ObjReader, GivesTheSameWhereverTheBufferCutsTheText) {
  const std::string text =
      "# head\r\nmtllib my tree.mtl\r\nv  0.5\t-1e-3  +2 \r\nv 1 0 0 0.1 0.2 0.3\nv 0 1 \\\n0\nvt "
      "0.25 "
      "0.75\nvn 0 0 1\ng a b\nusemtl bark 1\nf 1/1/1 2//1 3/1 \ng\nf -3 -2 -1\n";
  const ObjScene whole = parse(text);
  for (size_t size = 1; size < 80; ++size) {
    const ObjScene cut = parse(text, size);
    EXPECT_EQ(cut.material_libraries, whole.material_libraries) << size;
    expect_same(cut, whole, std::to_string(size));
  }
  EXPECT_EQ(whole.positions[0], glm::vec3(0.5f, -1e-3f, 2.0f));
  EXPECT_EQ(whole.positions[2], glm::vec3(0, 1, 0));
  EXPECT_THAT(whole.names, ElementsAre("a b"));
  EXPECT_THAT(whole.materials, ElementsAre("bark 1"));
  EXPECT_THAT(whole.material_libraries, ElementsAre("my tree.mtl"));
  EXPECT_THAT(whole.corner_uv, ElementsAre(0, -1, 0, -1, -1, -1));
  ASSERT_EQ(whole.runs.size(), 2u);
  EXPECT_EQ(whole.runs[1].group, -1);
}

TEST(ObjReader, GivesTheSameWithAnyNumberOfThreadsAndPieces) {
  std::string text;
  for (int i = 0; i < 60; ++i) {
    const std::string number = std::to_string(i);
    text += "v " + number + ".5 0 -1e-3\nv 0 " + number + " 1\nv 1 \\\n0 " + number + "\n";
    if (i % 7 == 0) text += "g part" + std::to_string(i % 3) + "\n";
    if (i % 11 == 0) text += "o tree" + number + "\n";
    if (i % 5 == 0) text += "usemtl m" + std::to_string(i % 2) + "\nvt 0." + number + " 1\n";
    text += i % 4 == 0 ? "f -1/-1 -2/-1 -3/-1\n" : "f 1 -2 " + std::to_string(180 - i) + "\n";
    if (i % 13 == 0) text += "f -1 -2\nl 1 2\n";
  }
  const auto read = [&](size_t buffer_size, int threads) {
    std::istringstream stream(text);
    return read_obj(stream, "t.obj", {.buffer_size = buffer_size, .threads = threads});
  };
  // One line at a time, more or less.
  const ObjScene lines = read(1, 1);
  EXPECT_EQ(lines.positions.size(), 180u);
  EXPECT_EQ(lines.face_count(), 60);
  EXPECT_EQ(lines.corner_vertex[0], 2);
  for (const size_t size : {size_t{64}, size_t{1000}, size_t{1} << 20}) {
    for (const int threads : {1, 2, 5}) {
      expect_same(read(size, threads), lines,
                  std::to_string(size) + " bytes, " + std::to_string(threads) + " threads");
    }
  }
}

TEST(ObjReader, NamesTheFirstOfSeveralBadLines) {
  std::string text = kTriangle;
  for (int i = 0; i < 200; ++i) text += "f 1 2 3\n";
  // In different pieces; the first error depends on the text before its piece.
  EXPECT_THAT(error_of(text + "f 1 2 -5\n" + text + "v x\n"), HasSubstr("t.obj:204: "));
  EXPECT_THAT(error_of(text + "v x\n" + text + "f 1 2 -9\n"), HasSubstr("t.obj:204: "));
  // On one line, and on one after the other.
  EXPECT_THAT(error_of(text + "f -5 x\n"), HasSubstr("vertex index -5 is out of range (3 so far)"));
  EXPECT_THAT(error_of(text + "f -4 1\nf 1 2 x\n"), HasSubstr("t.obj:204: "));
}

TEST(ObjReader, TextureCoordinatesOfFacesLeftOutDoNotCount) {
  const std::string text = kTriangle + "vt 0 0\nf 1 2 3\nf 1/1 2/1\nf 1 2 3\n";
  for (const size_t size : {1, 16, 64, 4096}) {
    EXPECT_TRUE(parse(text, size).corner_uv.empty()) << size;
  }
}

TEST(ObjReader, TakesNegativeIndicesFromWhereTheyStand) {
  const ObjScene scene = parse(kTriangle + "f -3 -2 -1\nv 5 5 5\nf -1 1 2\n");
  EXPECT_THAT(scene.corner_vertex, ElementsAre(0, 1, 2, 3, 0, 1));
}

TEST(ObjReader, AnInvalidFaceLeavesNoCornersForNegativeIndices) {
  // The face's corners are incomplete, so that setting them would write beyond the arrays.
  std::string text = "v 0 0 0\nvt 0 0\nf -1/-1 -1/-1x\n";
  const ObjFragment fragment = read_obj_fragment(text.data(), text.data() + text.size(), {});
  EXPECT_EQ(fragment.error, "malformed face corner '-1/-1x'");
  EXPECT_EQ(fragment.relative.size(), 4u);
  for (const RelativeIndex& entry : fragment.relative) EXPECT_EQ(entry.corner, -1);
}

TEST(ObjReader, TakesIndicesOfVerticesThatComeLater) {
  EXPECT_THAT(parse("f 1 2 3\n" + kTriangle).corner_vertex, ElementsAre(0, 1, 2));
}

TEST(ObjReader, TakesALastLineWithoutBreak) {
  EXPECT_EQ(parse(kTriangle + "f 1 2 3").face_count(), 1);
}

TEST(ObjReader, TakesALastLineThatEndsInAContinuation) {
  EXPECT_EQ(parse(kTriangle + "f 1 2 3 \\\n").face_count(), 1);
  EXPECT_EQ(parse(kTriangle + "f 1 2 3 \\").face_count(), 1);
}

TEST(ObjReader, DoesNotContinueComments) {
  EXPECT_EQ(parse("# C:\\trees\\\n" + kTriangle + "f 1 2 3\n").positions.size(), 3u);
}

TEST(ObjReader, TakesAByteOrderMark) {
  EXPECT_EQ(parse("\xEF\xBB\xBF" + kTriangle + "f 1 2 3\n").positions.size(), 3u);
}

TEST(ObjReader, StartsARunWhereverGroupObjectOrMaterialChanges) {
  const ObjScene scene =
      parse(kTriangle +
            "o tree\ng one\nf 1 2 3\ng one\nf 1 2 3\nusemtl m\nf 1 2 3\no two\nf 1 2 "
            "3\n");
  ASSERT_EQ(scene.runs.size(), 3u);
  EXPECT_EQ(scene.runs[1].first_face, 2);
  EXPECT_EQ(scene.runs[2].group, -1);
  EXPECT_EQ(scene.names[scene.runs[2].object], "two");
}

TEST(ObjReader, EmptyGroupsMakeNoRun) {
  EXPECT_EQ(parse(kTriangle + "g a\ng b\ng c\nf 1 2 3\ng d\n").runs.size(), 1u);
}

TEST(ObjReader, CountsWhatItLeavesOut) {
  const ObjScene scene = parse(kTriangle + "f 1 2 3\nf 1 2\nl 1 2\np 1\n");
  EXPECT_EQ(scene.short_faces, 1);
  EXPECT_EQ(scene.loose_elements, 2);
  EXPECT_EQ(scene.face_count(), 1);
}

TEST(ObjReader, RoundsNumbersAsTheCompilerDoes) {
  const ObjScene scene = parse(
      "v 0.1 -123456.789012 .5\nv 5. -0 1234567890.12345678\nv 3.4028234e38 1e-45 "
      "0.000000000000001\nf 1 2 3\n");
  EXPECT_EQ(scene.positions[0], glm::vec3(0.1f, -123456.789012f, 0.5f));
  EXPECT_EQ(scene.positions[1], glm::vec3(5.0f, -0.0f, 1234567890.12345678f));
  EXPECT_EQ(scene.positions[2], glm::vec3(3.4028234e38f, 1e-45f, 0.000000000000001f));
}

TEST(ObjReader, UnderflowIsZero) {
  EXPECT_EQ(parse("v 1e-400 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").positions[0].x, 0.0f);
}

struct BadLine {
  const char* text;
  const char* message;
};

class ObjReaderErrors : public testing::TestWithParam<BadLine> {};

TEST_P(ObjReaderErrors, NameFileAndLine) {
  const std::string text = kTriangle + "# a \\\n" + GetParam().text + "\nf 1 2 3\n";
  for (const size_t size : {1u, 7u, 4096u}) {
    EXPECT_THAT(error_of(text, size), testing::StartsWith("t.obj:5: "));
    EXPECT_THAT(error_of(text, size), HasSubstr(GetParam().message));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Lines, ObjReaderErrors,
    testing::Values(BadLine{"v 1 2", "missing"}, BadLine{"v 1 2 x", "malformed number 'x'"},
                    BadLine{"v 1 2 3.0.0", "malformed number"}, BadLine{"v 1,5 2 3", "malformed"},
                    BadLine{"v nan 0 0", "not finite"}, BadLine{"v 0 inf 0", "not finite"},
                    BadLine{"v 0 1e39 0", "not finite"}, BadLine{"v 0 1e400 0", "not finite"},
                    BadLine{"vt u", "malformed number"}, BadLine{"vn 0 0", "missing"},
                    BadLine{"f 1 2 4", "out of range"}, BadLine{"f 1 2 -4", "out of range"},
                    BadLine{"f 1 2 0", "counts from 1"},
                    BadLine{"f 1 2 x", "malformed vertex index"},
                    BadLine{"f 1 2 3x", "malformed face corner '3x'"},
                    BadLine{"f 1/1 2/1 3/1", "texture coordinate index 1 is out of range"},
                    BadLine{"f 1//1 2//1 3//1", "normal index 1 is out of range"},
                    BadLine{"f 1 2 99999999999999999999", "out of range"},
                    BadLine{"f 1 2 4000000000", "out of range"},
                    BadLine{"f 1/2/3/4 2 3", "malformed face corner"}));

TEST(ObjReader, CountsContinuedLines) {
  EXPECT_THAT(error_of("v 0 0 \\\n0\nv 1 \\\r\n 0 \\\r\n 0\nv x 0 0\n", 3),
              testing::StartsWith("t.obj:6:"));
}

TEST(ObjReader, NamesTheFirstLineThatPointsTooFar) {
  EXPECT_THAT(error_of("f 1 2 3\nf 1 2 9\nf 1 2 8\n" + kTriangle), testing::StartsWith("t.obj:2:"));
}

TEST(ObjReader, AnEmptyFileIsNoObj) {
  EXPECT_THAT(error_of(""), HasSubstr("not a Wavefront OBJ"));
}

TEST(ObjReader, ATextIsNoObj) {
  EXPECT_THAT(error_of("Dear reader,\nthis is a letter.\n"), HasSubstr("not a Wavefront OBJ"));
}

TEST(ObjReader, BinaryDataIsNoObj) {
  EXPECT_THAT(error_of(std::string("v 0\0 0", 7)), HasSubstr("not a text file"));
}

TEST(ObjReader, VerticesAloneAreNoTree) {
  EXPECT_THAT(error_of(kTriangle), HasSubstr("no faces"));
}

TEST(ObjReader, StopsWhenAskedTo) {
  std::istringstream stream(kTriangle + "f 1 2 3\n");
  EXPECT_THROW(read_obj(stream, "t.obj", {.progress = [](float) { return false; }}),
               base::Cancelled);
}

TEST(ObjReader, ReportsTheShareRead) {
  const std::string text = kTriangle + "f 1 2 3\n";
  std::istringstream stream(text);
  std::vector<float> shares;
  read_obj(stream, "t.obj",
           {.buffer_size = 9, .total_size = text.size(), .progress = [&](float share) {
              shares.push_back(share);
              return true;
            }});
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_FLOAT_EQ(shares.front(), 0.0f);
  EXPECT_GT(shares.back(), 0.7f);
}

TEST(ObjReader, AMissingFileIsBadInput) {
  EXPECT_THROW(read_obj_file("/nowhere/tree.obj"), std::invalid_argument);
}

TEST(Parts, SplitsByIndexThoughPositionsAreEqual) {
  const Parts parts = split_parts(parse(kTriangle + kTriangle + "f 1 2 3\nf 4 5 6\n"));
  EXPECT_EQ(parts.count(), 2);
}

TEST(Parts, NumbersPartsByTheirFirstFace) {
  const Parts parts =
      split_parts(parse(kTriangle + kTriangle + "v 9 9 9\ng b\nf 4 5 6\ng a\nf 1 2 3\nf 6 5 4\n"));
  ASSERT_EQ(parts.count(), 2);
  EXPECT_THAT(std::vector<int32_t>(parts.part_faces(0).begin(), parts.part_faces(0).end()),
              ElementsAre(0, 2));
  EXPECT_THAT(std::vector<int32_t>(parts.part_vertices(0).begin(), parts.part_vertices(0).end()),
              ElementsAre(3, 4, 5));
  EXPECT_THAT(parts.run, ElementsAre(0, 1));
}

TEST(ReadObj, LinesMayEndByCarriageReturnsAlone) {
  const std::string text = "g a\n" + kTriangle + "vt 0 1\nf 1/1 2/1 3/1\nv 1 2 \\\n3\nf -1 2 3\n";
  const auto with_ends = [&](const std::string& end) {
    std::string changed;
    for (const char c : text) changed += c == '\n' ? end : std::string(1, c);
    return changed;
  };
  const ObjScene expected = parse(text);
  for (const size_t buffer : {1, 2, 3, 5, 8, 13, 21, 1 << 16}) {
    for (const char* end : {"\r", "\r\n"}) {
      expect_same(parse(with_ends(end), buffer), expected, "buffer of " + std::to_string(buffer));
    }
  }
  EXPECT_THAT(error_of("v 0 0 0\rv 1 0\rf 1 1 1\r"), HasSubstr("t.obj:2: a number is missing"));
}

TEST(ReadObj, AnOriginIsTakenOffBeforeNumbersAreRounded) {
  std::istringstream stream("v 10000000.25 0 -3\nv 10000000.5 0 -3\nv 10000000.5 1 -3\nf 1 2 3\n");
  ObjReadOptions options;
  options.origin = {1e7, 0.0, -3.0};
  const ObjScene scene = read_obj(stream, "t.obj", options);
  EXPECT_THAT(scene.positions,
              ElementsAre(glm::vec3(0.25f, 0, 0), glm::vec3(0.5f, 0, 0), glm::vec3(0.5f, 1, 0)));
}

}  // namespace
}  // namespace snowbough::tree
