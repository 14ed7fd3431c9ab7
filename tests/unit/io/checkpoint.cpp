#include <cdem/core/random.hpp>
#include <cdem/io/checkpoint.hpp>
#include <cdem/io/packing_file.hpp>

#include <doctest/doctest.h>

#include <limits>

#include "temporary_folder.hpp"

using namespace cdem;

namespace {

/// A checkpoint with a section of every sort, of lengths that are no multiple of 8 bytes among them.
void write_sample(const std::filesystem::path& path) {
  io::CheckpointWriter checkpoint(path);
  checkpoint.add("numbers", std::vector<double>{1.5, -0.0, std::numeric_limits<double>::quiet_NaN()});
  checkpoint.add("positions", std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}});
  checkpoint.add("phases", std::vector<std::uint8_t>{1, 2, 3});
  checkpoint.add("empty", std::vector<float>{});
  checkpoint.add("step", std::uint64_t{12345678901234});
  checkpoint.add("text", "alumina, E_mu = 2536 GPa");
  checkpoint.commit();
}

std::string refusal(const std::filesystem::path& path) {
  const std::string message = message_of<core::FileError>([&] { io::CheckpointReader reader(path); });
  if (!message.empty())
    CHECK(contains(message, "cannot read " + path.string() + ": "));
  return message;
}

particles::ParticleSet some_particles(std::size_t count) {
  core::Random random(7);
  particles::ParticleSet set;
  set.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    set.position[i] = Vec3(random.uniform(), random.uniform(), random.uniform());
    set.radius[i] = random.uniform(0.01, 0.02);
    set.phase[i] = static_cast<PhaseIndex>(random.bits() % 3);
  }
  return set;
}

} // namespace

TEST_CASE("Every sort of section reads back to the same bits") {
  const TemporaryFolder folder;
  write_sample(folder / "a.cdem");
  const io::CheckpointReader reader(folder / "a.cdem");
  CHECK(reader.names() ==
        std::vector<std::string>{"numbers", "positions", "phases", "empty", "step", "text"});
  const auto numbers = reader.read<double>("numbers");
  REQUIRE(numbers.size() == 3);
  CHECK(numbers[0] == 1.5);
  CHECK(std::signbit(numbers[1]));
  CHECK(std::isnan(numbers[2]));
  CHECK(reader.read<Vec3>("positions") == std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}});
  CHECK(reader.read<std::array<double, 3>>("positions")[1] == std::array<double, 3>{4, 5, 6});
  CHECK(reader.read<std::uint8_t>("phases") == std::vector<std::uint8_t>{1, 2, 3});
  CHECK(reader.read<float>("empty").empty());
  CHECK(reader.read_value<std::uint64_t>("step") == 12345678901234);
  CHECK(reader.read_text("text") == "alumina, E_mu = 2536 GPa");
  CHECK(reader.has("step"));
  CHECK_FALSE(reader.has("steps"));
}

TEST_CASE("The padded six-component field reads back into its aligned container") {
  const TemporaryFolder folder;
  particles::SpatialField<> field(1000);
  core::Random random(3);
  for (auto& spatial : field)
    for (int dof = 0; dof < 6; ++dof)
      spatial[dof] = random.normal();
  io::CheckpointWriter writer(folder / "a.cdem");
  writer.add("displacement", field);
  writer.commit();
  particles::SpatialField<> back;
  io::CheckpointReader(folder / "a.cdem").read("displacement", back);
  REQUIRE(back.size() == field.size());
  CHECK(std::memcmp(back.data(), field.data(), field.size() * sizeof field[0]) == 0);
}

TEST_CASE("A file cut anywhere is refused and said to be truncated") {
  const TemporaryFolder folder;
  write_sample(folder / "a.cdem");
  const std::string whole = content_of(folder / "a.cdem");
  for (std::size_t length = 0; length < whole.size(); ++length) {
    put(folder / "cut.cdem", whole.substr(0, length));
    const std::string message = refusal(folder / "cut.cdem");
    const std::string expected = length < 32
                                     ? "it is no checkpoint, " + std::to_string(length) + " bytes are too few"
                                     : "it has " + std::to_string(length) + " bytes where " +
                                           std::to_string(whole.size()) + " were written: it is truncated";
    CHECK_MESSAGE(contains(message, expected), message);
  }
  put(folder / "cut.cdem", whole + "x");
  CHECK(contains(refusal(folder / "cut.cdem"), "bytes where"));
}

TEST_CASE("A single bit flipped anywhere is noticed") {
  const TemporaryFolder folder;
  write_sample(folder / "a.cdem");
  const std::string whole = content_of(folder / "a.cdem");
  REQUIRE(refusal(folder / "a.cdem") == "");
  std::size_t unnoticed = 0;
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    std::string altered = whole;
    altered[bit / 8] = static_cast<char>(altered[bit / 8] ^ (1 << bit % 8));
    put(folder / "altered.cdem", altered);
    const std::string message = refusal(folder / "altered.cdem");
    unnoticed += message.empty();
    if (bit / 8 >= 32)
      CHECK_MESSAGE(contains(message, "its checksum is wrong: it was altered"), message);
  }
  CHECK(unnoticed == 0);
}

TEST_CASE("Two signs flipped, words exchanged and zeros written are noticed by the checksum") {
  std::vector<double> values{1, 2, 3, 4, 0, 0, 7};
  const auto checksum = [](const std::vector<double>& v) {
    io::detail::Checksum sum;
    sum.update(reinterpret_cast<const std::byte*>(v.data()), v.size() * sizeof(double));
    return sum.value();
  };
  const auto original = checksum(values);
  for (std::size_t i = 0; i < values.size(); ++i)
    for (std::size_t j = i + 1; j < values.size(); ++j) {
      auto flipped = values;
      flipped[i] = -flipped[i];
      flipped[j] = -flipped[j];
      CHECK(checksum(flipped) != original);
      auto exchanged = values;
      std::swap(exchanged[i], exchanged[j]);
      CHECK((exchanged == values || checksum(exchanged) != original));
    }
  values.insert(values.begin() + 4, 0.0);
  CHECK(checksum(values) != original);
}

TEST_CASE("Files of another kind, version or byte order are told apart") {
  const TemporaryFolder folder;
  put(folder / "a.txt", "quantity,value,unit\nalumina.youngs_modulus,3.5e11,Pa\n");
  CHECK(contains(refusal(folder / "a.txt"), "it is no checkpoint, its first bytes are others"));
  write_sample(folder / "a.cdem");
  const std::string whole = content_of(folder / "a.cdem");
  std::string other = whole;
  other[8] = 2;
  put(folder / "b.cdem", other);
  CHECK(contains(refusal(folder / "b.cdem"), "its format is version 2, this program reads version 1"));
  other = whole;
  std::swap(other[12], other[15]);
  std::swap(other[13], other[14]);
  put(folder / "b.cdem", other);
  CHECK(contains(refusal(folder / "b.cdem"), "another byte order"));
  CHECK(contains(refusal(folder / "missing.cdem"), "No such file or directory"));
  CHECK(contains(refusal(folder.path()), "it is a folder"));
}

TEST_CASE("A head that makes no sense is refused even under a right checksum") {
  const TemporaryFolder folder;
  write_sample(folder / "a.cdem");
  const std::string whole = content_of(folder / "a.cdem");
  const auto forged = [&](std::size_t at, std::uint64_t value, std::size_t bytes) {
    std::string file = whole;
    std::memcpy(file.data() + at, &value, bytes);
    io::detail::Checksum sum;
    sum.update(reinterpret_cast<const std::byte*>(file.data()) + 32, file.size() - 32);
    const std::uint64_t checksum = sum.value();
    std::memcpy(file.data() + 24, &checksum, 8);
    put(folder / "forged.cdem", file);
    return refusal(folder / "forged.cdem");
  };
  CHECK(forged(32, 'n', 1) == ""); // forging itself works
  CHECK(contains(forged(32 + 56, ~std::uint64_t{0}, 8), "the head of section 1 makes no sense"));
  CHECK(contains(forged(32 + 56, std::uint64_t{1} << 61, 8), "the head of section 1 makes no sense"));
  CHECK(contains(forged(32 + 49, 0, 1), "the head of section 1 makes no sense"));
  CHECK(contains(forged(32 + 47, 'x', 1), "the head of section 1 makes no sense"));
}

TEST_CASE("A wrong name, type or number of values is refused with what there is") {
  const TemporaryFolder folder;
  write_sample(folder / "a.cdem");
  const io::CheckpointReader reader(folder / "a.cdem");
  CHECK(contains(message_of<core::FileError>([&] { reader.read<double>("velocity"); }),
                 "it has no section 'velocity'; there are: numbers, positions, phases, empty, step, text"));
  CHECK(contains(message_of<core::FileError>([&] { reader.read<double>("positions"); }),
                 "section 'positions' holds 3 x float64, float64 is expected"));
  CHECK(contains(message_of<core::FileError>([&] { reader.read<std::int8_t>("phases"); }),
                 "section 'phases' holds unsigned int8, int8 is expected"));
  CHECK(contains(message_of<core::FileError>([&] { reader.read_value<double>("numbers"); }),
                 "section 'numbers' holds 3 values, 1 is expected"));
}

TEST_CASE("Names of sections are checked when writing, and an unfinished checkpoint leaves nothing") {
  const TemporaryFolder folder;
  {
    io::CheckpointWriter writer(folder / "a.cdem");
    writer.add("a", 1);
    CHECK_THROWS_AS(writer.add("a", 2), core::InvalidInput);
    CHECK_THROWS_AS(writer.add("", 1), core::InvalidInput);
    CHECK_THROWS_AS(writer.add(std::string(48, 'x'), 1), core::InvalidInput);
    CHECK_THROWS_AS(writer.add(std::string_view("a\0b", 3), 1), core::InvalidInput);
    CHECK_NOTHROW(writer.add(std::string(47, 'x'), 1));
  }
  CHECK(folder.entries() == 0);
}

TEST_CASE("The same data give the same bytes") {
  const TemporaryFolder folder;
  write_sample(folder / "a.cdem");
  write_sample(folder / "b.cdem");
  CHECK(content_of(folder / "a.cdem") == content_of(folder / "b.cdem"));
}

TEST_CASE("A packing is loaded as it was saved") {
  const TemporaryFolder folder;
  const auto particles = some_particles(1001);
  geometry::Box box{Vec3(-0.5, 0, 0), Vec3(1, 2, 3), {true, false, true}};
  io::save_packing(folder / "p.cdem", particles, box,
                   {.parameters = "seed = 7\n", .report = "density = 0.6\n"});
  const io::PackingFile back = io::load_packing(folder / "p.cdem");
  CHECK(back.particles.position == particles.position);
  CHECK(back.particles.radius == particles.radius);
  CHECK(back.particles.phase == particles.phase);
  CHECK(back.box.lower == box.lower);
  CHECK(back.box.upper == box.upper);
  CHECK(back.box.periodic == box.periodic);
  CHECK(back.parameters == "seed = 7\n");
  CHECK(back.report == "density = 0.6\n");
}

TEST_CASE("A compact packing is half as long and as near as it says; equal radii and phase 0 take no room") {
  const TemporaryFolder folder;
  geometry::Box box{Vec3(-1, 0, 2), Vec3(1, 4, 3), {true, true, false}};
  auto particles = some_particles(3000);
  for (std::size_t i = 0; i < particles.size(); ++i) // inside the walls, anywhere along the periodic axes
    particles.position[i].z() = 2 + static_cast<double>(i) / 2999;
  std::fill(particles.phase.begin(), particles.phase.end(), PhaseIndex{0});
  io::save_packing(folder / "all.cdem", particles, box);
  io::save_packing(folder / "compact.cdem", particles, box, {.digits = io::PackingDigits::compact});
  const auto all = std::filesystem::file_size(folder / "all.cdem");
  const auto compact = std::filesystem::file_size(folder / "compact.cdem");
  CHECK(all < 3000 * 32 + 1000);
  CHECK(compact < 3000 * 16 + 1000);
  const io::PackingFile back = io::load_packing(folder / "compact.cdem");
  REQUIRE(back.particles.size() == 3000);
  CHECK(back.particles.phase == particles.phase);
  const Vec3 off = 0x1p-33 * box.size() * (1 + 1e-6);
  for (std::size_t i = 0; i < 3000; ++i) {
    const Vec3 difference = box.minimum_image(back.particles.position[i] - particles.position[i]).cwiseAbs();
    REQUIRE((difference.array() <= off.array() + 1e-15).all());
    REQUIRE(back.particles.radius[i] == doctest::Approx(particles.radius[i]).epsilon(6e-8));
  }

  std::fill(particles.radius.begin(), particles.radius.end(), 0.1);
  io::save_packing(folder / "equal.cdem", particles, box);
  CHECK(std::filesystem::file_size(folder / "equal.cdem") < 3000 * 24 + 1000);
  CHECK(io::load_packing(folder / "equal.cdem").particles.radius == particles.radius);

  particles.position[7].z() = 3.5; // behind a wall
  CHECK(contains(message_of<core::InvalidInput>([&] {
                   io::save_packing(folder / "x.cdem", particles, box,
                                    {.digits = io::PackingDigits::compact});
                 }),
                 "position z of particle 7 = 3.5"));
  CHECK_FALSE(std::filesystem::exists(folder / "x.cdem"));
}

TEST_CASE("What is no packing is neither saved nor loaded") {
  const TemporaryFolder folder;
  auto particles = some_particles(3);
  const auto box = geometry::Box::cube(1, true);
  write_sample(folder / "a.cdem");
  CHECK(contains(message_of<core::FileError>([&] { io::load_packing(folder / "a.cdem"); }),
                 "no section 'position'"));
  particles.radius[1] = -1;
  CHECK_THROWS_AS(io::save_packing(folder / "p.cdem", particles, box), core::InvalidInput);
  CHECK_THROWS_AS(io::save_packing(folder / "p.cdem", {}, box), core::InvalidInput);
  CHECK_FALSE(std::filesystem::exists(folder / "p.cdem"));
  io::CheckpointWriter forged(folder / "p.cdem");
  forged.add("position", particles.position);
  forged.add("radius", particles.radius);
  forged.add("phase", particles.phase);
  forged.add("box", std::array{0.0, 0.0, 0.0, 1.0, 1.0, 1.0});
  forged.add("periodic", std::array<std::uint8_t, 3>{});
  forged.add("parameters", "");
  forged.commit();
  CHECK(contains(message_of<core::FileError>([&] { io::load_packing(folder / "p.cdem"); }),
                 "cannot read " + (folder / "p.cdem").string() + ": radius of particle 1 = -1"));
}
