// Films as numbered files: which files are of them, times, and frames that are refused.
#include <gtest/gtest.h>

#include <fstream>

#include "core/math/error.hpp"
#include "core/model/mesh/film_file.hpp"
#include "core/model/mesh/read_mesh.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::film_file_test {
namespace {

const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

class Folder {
 public:
  std::string add(const std::string& name, const std::string& content = triangle) {
    const auto path = folder_.path() / name;
    std::ofstream(path) << content;
    return path.string();
  }

 private:
  test::TemporaryFolder folder_;
};

template <class F>
std::string refusal(const F& act) {
  try {
    act();
  } catch (const ConfigError& error) {
    const Violation& first = error.violations().front();
    return first.where + ": " + first.found + "; " + first.allowed;
  }
  return "";
}
void expect_says(const std::string& text, const std::vector<std::string>& words) {
  for (const std::string& word : words)
    EXPECT_NE(text.find(word), std::string::npos) << word << " in: " << text;
}

TEST(FilmFiles, AreThoseWhoseNamesDifferInTheLastNumberAlone) {
  Folder folder;
  const std::string first = folder.add("take2_walk_8.obj");
  const std::vector<std::string> rest = {folder.add("take2_walk_9.obj"), folder.add("take2_walk_10.obj"),
                                         folder.add("take2_walk_11.obj")};
  for (const char* other :
       {"take2_walk_7.obj", "take3_walk_12.obj", "take2_walk_12.ply", "obstacles_12.obj", "take2_walk.obj"}) {
    folder.add(other);
  }
  std::vector<std::string> all = {first};
  all.insert(all.end(), rest.begin(), rest.end());
  EXPECT_EQ(film_files(first), all);
}

TEST(FilmFiles, NameWhatIsMissing) {
  Folder folder;
  expect_says(refusal([&] { film_files(folder.add("walk.obj")); }), {"walk.obj", "without a number"});
  const std::string first = folder.add("a_0.obj");
  expect_says(refusal([&] { film_files(first); }), {"a_0.obj", "one frame", "two or more"});
  folder.add("a_1.obj"), folder.add("a_3.obj");
  expect_says(refusal([&] { film_files(first); }), {"no frame between a_1.obj and a_3.obj", "even steps"});
  folder.add("a_2.obj");
  EXPECT_EQ(film_files(first).size(), 4u);
  folder.add("a_01.obj");
  expect_says(refusal([&] { film_files(first); }), {"the number of", "one frame a number"});
  expect_says(refusal([&] { film_files(first + "/b_0.obj"); }), {"a folder of mesh files"});
}

TEST(FilmTimes, AreTheColumnOfThatName) {
  EXPECT_EQ(parse_film_times("frame,time_s\r\n0,0.5\r\n1,0.75\r\n", "times.csv"),
            (std::vector<double>{0.5, 0.75}));
  expect_says(refusal([] { parse_film_times("frame,time_s\n0,0\n1\n", "times.csv"); }),
              {"times.csv:3", "\"\""});
  EXPECT_EQ(parse_film_times("frame,step,time_s\n0,-1,0.0\n1,0,0.25\n", "times.csv"),
            (std::vector<double>{0, 0.25}));
  expect_says(refusal([] { parse_film_times("frame,time\n0,1\n", "times.csv"); }), {"times.csv:1", "time_s"});
  expect_says(refusal([] { parse_film_times("time_s\n0\nnan\n", "times.csv"); }),
              {"times.csv:3", "\"nan\"", "finite"});
  expect_says(refusal([] { parse_film_times("time_s\n0\n1s\n", "times.csv"); }), {"times.csv:3", "\"1s\""});
}

TEST(FilmFrames, HaveTheVerticesAndCellsOfTheMesh) {
  const TriangleMesh mesh = parse_mesh(triangle, "body.obj");
  const std::string moved = "v 0 0 1\nv 1 0 1\nv 0 1 1\n";
  const Positions x = parse_film_frame(moved + "f 1 2 3\n", "f_1.obj", mesh);
  EXPECT_EQ(x.row(2), Eigen::RowVector3d(1, 1, 1));
  const auto refused = [&mesh](const std::string& text) {
    return refusal([&] { parse_film_frame(text, "f_1.obj", mesh); });
  };
  expect_says(refused("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\n"),
              {"f_1.obj", "4 vertices", "3, as the mesh"});
  expect_says(refused(moved + "f 1 3 2\n"), {"f_1.obj", "triangles 0 of other vertices", "in their order"});
  expect_says(refused(moved + "f 1 2 3\nf 1 3 2\n"), {"f_1.obj", "2 triangles", "1, as the mesh"});
  expect_says(refused("v 0 nan 1\nv 1 0 1\nv 0 1 1\nf 1 2 3\n"), {"f_1.obj", "nan"});
  expect_says(refused("v 0 1e16 1\nv 1 0 1\nv 0 1 1\nf 1 2 3\n"), {"f_1.obj", "vertex 0", "1e+16"});
}

}  // namespace
}  // namespace bb::film_file_test
