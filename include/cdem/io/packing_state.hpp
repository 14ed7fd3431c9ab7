#pragma once

/// @file
/// Packings in mid-course kept in a file: a long run goes on after a stop.

#include <cdem/io/checkpoint.hpp>
#include <cdem/packing/lubachevsky_stillinger.hpp>

namespace cdem::io {

/// Saves where a run stands, for example as LubachevskyStillinger::Checkpoints::save.
///
/// @throws core::FileError  if the file cannot be written; what was there before is still there then
/// @complexity O(particles), no copy; about 100 bytes a particle
inline void save_packing_state(const std::filesystem::path& path,
                               const packing::LubachevskyStillinger::State& state) {
  CheckpointWriter file(path);
  file.add("spheres", state.spheres);
  file.add("partners", state.partners);
  file.add("numbers", state.numbers);
  file.add("counts", state.counts);
  file.add("parameters", state.parameters);
  file.commit();
}

/// Loads what save_packing_state() wrote, to the same bits.
///
/// @throws core::FileError  naming the file if it is missing, damaged, or holds no such state
inline packing::LubachevskyStillinger::State load_packing_state(const std::filesystem::path& path) {
  const CheckpointReader file(path);
  packing::LubachevskyStillinger::State state;
  file.read("spheres", state.spheres);
  file.read("partners", state.partners);
  file.read("numbers", state.numbers);
  file.read("counts", state.counts);
  state.parameters = file.read_text("parameters");
  return state;
}

} // namespace cdem::io
