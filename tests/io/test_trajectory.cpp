#include <gtest/gtest.h>

#include "io/python.h"
#include "io/sample_frame.h"
#include "io/temporary_directory.h"
#include "odpd/core/error.h"
#include "odpd/io/file.h"
#include "odpd/io/trajectory.h"
#include "support/errors.h"

namespace odpd {
namespace {

namespace fs = std::filesystem;
using test::message_of;
using test::sample_frame;
using test::TemporaryDirectory;

TrajectorySegments segments_in(const TemporaryDirectory& directory) {
  return {directory.path(), "seed = 1\n", "0.1.0", "a title"};
}

void expect_equal(const Frame& a, const Frame& b) {
  EXPECT_EQ(a.dimension, b.dimension);
  EXPECT_EQ(a.step, b.step);
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.box_size, b.box_size);
  EXPECT_EQ(a.periodic, b.periodic);
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.species, b.species);
  EXPECT_EQ(a.group, b.group);
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.image, b.image);
  EXPECT_EQ(a.velocity, b.velocity);
  EXPECT_EQ(a.species_names, b.species_names);
}

class TrajectoryIn : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Dimensions, TrajectoryIn, testing::Values(2, 3));

TEST_P(TrajectoryIn, LastFrameReadsBack) {
  const TemporaryDirectory directory;
  TrajectorySegments segments = segments_in(directory);
  for (const int step : {0, 10, 20}) segments.append(sample_frame(GetParam(), 7, step));
  segments.close_segment();
  expect_equal(read_h5md(directory / "trajectory.0000.h5"), sample_frame(GetParam(), 7, 20));
}

TEST(Trajectory, SegmentsAreWrittenWhenTheyClose) {
  const TemporaryDirectory directory;
  TrajectorySegments segments = segments_in(directory);
  segments.close_segment();
  EXPECT_EQ(segments.segment(), 0);
  segments.append(sample_frame(2, 4, 1));
  EXPECT_TRUE(fs::is_empty(directory.path()));
  segments.close_segment();
  EXPECT_EQ(segments.segment(), 1);
  segments.append(sample_frame(2, 5, 2));
  segments.close_segment();
  EXPECT_EQ(read_h5md(directory / "trajectory.0000.h5").id.size(), 4u);
  EXPECT_EQ(read_h5md(directory / "trajectory.0001.h5").id.size(), 5u);
  segments.append(sample_frame(2, 5, 3));
  EXPECT_THROW(segments.append(sample_frame(2, 6, 4)), IoError);
}

TEST(Trajectory, ResumeDeletesLaterSegmentsAndWritesTheSameBytes) {
  const TemporaryDirectory directory;
  TrajectorySegments segments = segments_in(directory);
  std::vector<std::string> bytes;
  for (int k = 0; k < 4; ++k) {
    segments.append(sample_frame(3, 4, k));
    segments.close_segment();
    bytes.push_back(read_file(directory / ("trajectory.000" + std::to_string(k) + ".h5")));
  }
  for (const char* name : {"trajectory.12345.h5", "trajectory.x.h5", "trajectory.0003.h5.old"}) {
    write_file_atomically(directory / name, std::string("text"));
  }
  TrajectorySegments resumed = segments_in(directory);
  resumed.reopen(2, 0);
  EXPECT_TRUE(fs::exists(directory / "trajectory.0002.h5")) << "nothing is touched yet";
  resumed.delete_later();
  EXPECT_TRUE(fs::exists(directory / "trajectory.0001.h5"));
  EXPECT_FALSE(fs::exists(directory / "trajectory.0002.h5"));
  EXPECT_FALSE(fs::exists(directory / "trajectory.0003.h5"));
  EXPECT_FALSE(fs::exists(directory / "trajectory.12345.h5"));
  EXPECT_TRUE(fs::exists(directory / "trajectory.x.h5"));
  EXPECT_TRUE(fs::exists(directory / "trajectory.0003.h5.old"));
  for (int k = 2; k < 4; ++k) {
    resumed.append(sample_frame(3, 4, k));
    resumed.close_segment();
  }
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(read_file(directory / ("trajectory.000" + std::to_string(k) + ".h5")),
              bytes[static_cast<std::size_t>(k)]);
  }
}

TEST(Trajectory, GoesOnWithAnOpenSegment) {
  const TemporaryDirectory directory;
  TrajectorySegments whole = segments_in(directory);
  for (int k = 0; k < 5; ++k) whole.append(sample_frame(3, 4, k));
  whole.write_single("whole.h5", sample_frame(3, 4, 4));
  TrajectorySegments part = segments_in(directory);
  part.close_segment();
  for (int k = 0; k < 3; ++k) part.append(sample_frame(3, 4, k));
  part.save_segment();
  EXPECT_EQ(part.segment(), 0);
  EXPECT_EQ(part.frames(), 3);
  // More of it came onto the disk after the checkpoint that knows three frames.
  part.append(sample_frame(3, 4, 7));
  part.save_segment();
  write_file_atomically(directory / "trajectory.0001.h5", std::string("text"));
  TrajectorySegments resumed = segments_in(directory);
  resumed.reopen(0, 3);
  resumed.delete_later();
  EXPECT_TRUE(fs::exists(directory / "trajectory.0000.h5"));
  EXPECT_FALSE(fs::exists(directory / "trajectory.0001.h5"));
  for (int k = 3; k < 5; ++k) resumed.append(sample_frame(3, 4, k));
  resumed.close_segment();
  const H5Reader reader(directory / "trajectory.0000.h5");
  const std::string position = "/particles/all/position/";
  EXPECT_EQ(reader.read_integers(position + "step"), (std::vector<std::int64_t>{0, 1, 2, 3, 4}));
  EXPECT_EQ(reader.shape("/particles/all/box/edges/value").front(), 5);
  for (int k = 0; k < 5; ++k)
    EXPECT_EQ(reader.read_doubles(position + "value", k), sample_frame(3, 4, k).position);
  support::expect_error<IoError>([&] { segments_in(directory).reopen(0, 6); },
                                 {"trajectory.0000.h5", "5 frames", "knows 6", "--out"});
  support::expect_error<IoError>([&] { segments_in(directory).reopen(4, 1); },
                                 {"trajectory.0004.h5"});
}

TEST(Trajectory, GoesOnWithDensities) {
  const TemporaryDirectory directory;
  const auto frame = [](int step) {
    Frame with = sample_frame(2, 4, step);
    with.density = {0.1, 0.2, 0.3, 0.1 * step};
    return with;
  };
  TrajectorySegments part = segments_in(directory);
  for (const int step : {0, 1, 7}) part.append(frame(step));
  part.save_segment();
  TrajectorySegments resumed = segments_in(directory);
  resumed.reopen(0, 2);
  resumed.append(frame(2));
  resumed.close_segment();
  const H5Reader reader(directory / "trajectory.0000.h5");
  const std::string density = "/particles/all/density/value";
  EXPECT_EQ(reader.shape(density), (std::vector<std::int64_t>{3, 4}));
  for (int k = 0; k < 3; ++k) EXPECT_EQ(reader.read_doubles(density, k), frame(k).density);
}

// One number in 2D, three in 3D; a segment that goes on keeps as many as its frames.
TEST_P(TrajectoryIn, GoesOnWithAngularVelocities) {
  const TemporaryDirectory directory;
  const int components = GetParam() == 2 ? 1 : 3;
  const auto frame = [&](int step) {
    Frame with = sample_frame(GetParam(), 4, step);
    for (int k = 0; k < 4 * components; ++k) with.spin.push_back(0.1 * k + step);
    return with;
  };
  TrajectorySegments part = segments_in(directory);
  for (const int step : {0, 1, 7}) part.append(frame(step));
  part.save_segment();
  TrajectorySegments resumed = segments_in(directory);
  resumed.reopen(0, 2);
  resumed.append(frame(2));
  resumed.close_segment();
  const H5Reader reader(directory / "trajectory.0000.h5");
  const std::string spin = "/particles/all/angular_velocity/value";
  EXPECT_EQ(reader.shape(spin), components == 1 ? (std::vector<std::int64_t>{3, 4})
                                                : (std::vector<std::int64_t>{3, 4, 3}));
  for (int k = 0; k < 3; ++k) EXPECT_EQ(reader.read_doubles(spin, k), frame(k).spin);
}

TEST(Trajectory, IsH5mdToPython) {
  if (!test::python_has("h5py")) GTEST_SKIP() << "h5py is not installed";
  const TemporaryDirectory directory;
  TrajectorySegments segments = segments_in(directory);
  for (const int step : {5, 10, 15}) segments.append(sample_frame(2, 7, step));
  segments.close_segment();
  EXPECT_EQ(test::run_python(directory.path(), R"(
import sys, h5py, numpy as np
text = lambda value: value.decode() if isinstance(value, bytes) else value
with h5py.File(sys.argv[1], 'r') as f:
    assert list(f['h5md'].attrs['version']) == [1, 1]
    assert text(f['h5md/author'].attrs['name'])
    assert text(f['h5md/creator'].attrs['name']) == 'odpd'
    assert text(f['h5md/creator'].attrs['version']) == '0.1.0'
    box = f['particles/all/box']
    assert box.attrs['dimension'] == 2 and np.shape(box.attrs['dimension']) == ()
    assert [text(b) for b in box.attrs['boundary']] == ['periodic', 'none']
    for name, shape in [('box/edges', (3, 2, 2)), ('position', (3, 7, 2)), ('image', (3, 7, 2)),
                        ('velocity', (3, 7, 2))]:
        element = f['particles/all'][name]
        assert element['value'].shape == shape, name
        assert list(element['step']) == [5, 10, 15]
        assert np.allclose(element['time'], [0.025, 0.05, 0.075])
        assert element['step'] == f['particles/all/position/step']  # one object, many names
    for name in ['id', 'species', 'group']:
        assert f['particles/all'][name].shape == (7,) and f['particles/all'][name].dtype.kind == 'i'
    assert list(f['particles/all/id'][:3]) == [10, 13, 16]
    assert f['parameters/odpd/case'].asstr()[()] == 'seed = 1\n'
    assert text(f['parameters/odpd'].attrs['species_names'][0]) == 'water'
)",
                             directory / "trajectory.0000.h5"),
            0);
}

TEST(Trajectory, ReadsTimeDependentFileInTheStyleOfLammps) {
  if (!test::python_has("h5py")) GTEST_SKIP() << "h5py is not installed";
  const TemporaryDirectory directory;
  ASSERT_EQ(test::run_python(directory.path(), R"(
import sys, h5py, numpy as np
def element(group, name, value):
    g = group.create_group(name)
    g['step'] = np.array([0, 100], dtype='i4')
    g['time'] = np.array([0.0, 0.5])
    g['value'] = value
with h5py.File(sys.argv[1], 'w') as f:
    f.create_group('particles/empty')
    p = f.create_group('particles/fluid')
    x = np.arange(2 * 4 * 3, dtype='f4').reshape(2, 4, 3)
    element(p, 'position', x)
    element(p, 'velocity', -x)
    element(p, 'species', np.array([[1, 1, 2, 2], [1, 2, 3, 0]]))
    element(p, 'id', np.array([[1, 2, 3, 4], [3, 1, 2, -1]]))
    element(p, 'box/edges', np.array([[9.0, 9.0, 9.0], [10.0, 11.0, 12.0]]))
    p['box'].attrs['boundary'] = ['periodic', 'nonperiodic', 'periodic']
)",
                             directory / "lammps.h5"),
            0);
  const Frame frame = read_h5md(directory / "lammps.h5");
  EXPECT_EQ(frame.dimension, 3);
  EXPECT_EQ(frame.step, 100);
  EXPECT_EQ(frame.time, 0.5);
  EXPECT_EQ(frame.id, (std::vector<std::int64_t>{1, 2, 3}));
  EXPECT_EQ(frame.species, (std::vector<std::int64_t>{2, 3, 1}));
  EXPECT_EQ(frame.position, (std::vector<double>{15, 16, 17, 18, 19, 20, 12, 13, 14}));
  EXPECT_EQ(frame.velocity[0], -15.0);
  EXPECT_TRUE(frame.image.empty());
  EXPECT_EQ(frame.box_size, (std::vector<double>{10.0, 11.0, 12.0}));
  EXPECT_EQ(frame.periodic, (std::vector<bool>{true, false, true}));
}

TEST(Trajectory, ReadsFixedDatasetsAndIncrements) {
  if (!test::python_has("h5py")) GTEST_SKIP() << "h5py is not installed";
  const TemporaryDirectory directory;
  ASSERT_EQ(test::run_python(directory.path(), R"(
import sys, h5py, numpy as np
with h5py.File(sys.argv[1] + '/fixed.h5', 'w') as f:
    f['particles/p/position'] = np.array([[1.0, 2.0], [3.0, 4.0]])
    f['particles/p/box/edges'] = np.diag([5, 6])
with h5py.File(sys.argv[1] + '/increment.h5', 'w') as f:
    f['particles/p/position/value'] = np.zeros((4, 2, 2))
    f['particles/p/position/step'] = 10
    f['particles/p/position/step'].attrs['offset'] = 7
    f['particles/p/position/time'] = 0.5
with h5py.File(sys.argv[1] + '/tilted.h5', 'w') as f:
    f['particles/p/position'] = np.zeros((2, 2))
    f['particles/p/box/edges'] = np.array([[5.0, 0.0], [1.0, 5.0]])
with h5py.File(sys.argv[1] + '/none.h5', 'w') as f:
    f['particles/p/position/value'] = np.zeros((0, 2, 2))
)",
                             directory.path()),
            0);
  const Frame fixed = read_h5md(directory / "fixed.h5");
  EXPECT_EQ(fixed.position, (std::vector<double>{1, 2, 3, 4}));
  EXPECT_EQ(fixed.box_size, (std::vector<double>{5, 6}));
  EXPECT_EQ(fixed.id, (std::vector<std::int64_t>{0, 1}));
  EXPECT_TRUE(fixed.velocity.empty());
  EXPECT_TRUE(fixed.species.empty());
  const Frame increment = read_h5md(directory / "increment.h5");
  EXPECT_EQ(increment.step, 37);
  EXPECT_EQ(increment.time, 1.5);
  EXPECT_TRUE(increment.box_size.empty());
  const auto failure = [&](const std::string& name) {
    return message_of<IoError>([&] { read_h5md(directory / name); });
  };
  const Frame tilted = read_h5md(directory / "tilted.h5");
  EXPECT_EQ(tilted.box_size, (std::vector<double>{5, 5}));
  EXPECT_EQ(tilted.edges, (std::vector<double>{5, 0, 1, 5}));
  EXPECT_TRUE(fixed.edges.empty()) << "a diagonal matrix is no tilt";
  EXPECT_NE(failure("none.h5").find("no frame"), std::string::npos);
}

TEST(Trajectory, TiltedEdgesComeBackFrameByFrame) {
  const TemporaryDirectory directory;
  TrajectorySegments segments(directory.path(), "", "1", "t");
  Frame frame = sample_frame(3, 4, 7);
  frame.edges = {10.0, 0.0, 0.0, 2.5, 11.0, 0.0, 0.0, 0.0, 12.0};
  segments.append(frame);
  frame.edges[3] = -1.5;
  segments.append(frame);
  segments.close_segment();
  EXPECT_EQ(read_h5md(directory / "trajectory.0000.h5").edges, frame.edges);
}

TEST(Trajectory, RefusesFilesWithoutPositions) {
  const TemporaryDirectory directory;
  H5Image image;
  image.write("/particles/all/velocity", std::vector<double>{1.0, 2.0}, {1, 2});
  image.save(directory / "f.h5");
  EXPECT_NE(message_of<IoError>([&] { read_h5md(directory / "f.h5"); }).find("no positions"),
            std::string::npos);
}

}  // namespace
}  // namespace odpd
