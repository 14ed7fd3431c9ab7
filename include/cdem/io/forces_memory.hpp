#pragma once

/// @file
/// What bonds remember, in a checkpoint.

#include <cdem/bond/bond_forces.hpp>
#include <cdem/io/checkpoint.hpp>

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

namespace cdem::io {

namespace detail {

/// The same bytes as elements that a checkpoint knows.
template <class Element, class Value>
std::vector<Element> bytes_as(const std::vector<Value>& values) {
  static_assert(sizeof(Element) == sizeof(Value) && std::is_trivially_copyable_v<Element> &&
                std::is_trivially_copyable_v<Value>);
  std::vector<Element> elements(values.size());
  if (!values.empty())
    std::memcpy(static_cast<void*>(elements.data()), static_cast<const void*>(values.data()),
                values.size() * sizeof(Value));
  return elements;
}

template <class Value>
void read_bytes(const CheckpointReader& file, const std::string& name, std::vector<Value>& values) {
  using Bytes = std::array<std::uint8_t, sizeof(Value)>;
  const auto elements = file.read<Bytes>(name);
  if (elements.size() != values.size())
    file.fail("section '" + name + "' is of " + std::to_string(elements.size()) + " bonds, this body has " +
              std::to_string(values.size()));
  values = bytes_as<Value>(elements);
}

} // namespace detail

/// Adds what forces remember beside the motion: states of the bonds, orientations of the particles, energy lost.
///
/// States are written as their bytes: a checkpoint is for the program that wrote it. Forces that remember nothing add
/// nothing but that nothing was lost.
/// @tparam Law  its State is trivially copyable, as BondLaw asks
/// @throws core::FileError if the disk does not take it
/// @complexity O(bonds + particles)
template <class Law>
void add_memory(CheckpointWriter& file, const bond::BondForces<Law>& forces) {
  const auto& memory = forces.memory();
  const auto add = [&]<class Value>(const char* name, const std::vector<Value>& values) {
    file.add(name, detail::bytes_as<std::array<std::uint8_t, sizeof(Value)>>(values));
  };
  add("bond.state", memory.state);
  file.add("particle.displacement", memory.displacement);
  std::vector<std::array<double, 4>> orientation;
  for (const auto& q : memory.orientation)
    orientation.push_back({q.w, q.v.x(), q.v.y(), q.v.z()});
  file.add("particle.orientation", orientation);
  file.add("bond.dissipated", memory.dissipated);
}

/// Gives forces back what add_memory() wrote; they are those of the same law and body.
///
/// @throws core::FileError if a part is missing, or is that of another law (its State has another size) or body
template <class Law>
void read_memory(const CheckpointReader& file, bond::BondForces<Law>& forces) {
  auto memory = forces.memory();
  detail::read_bytes(file, "bond.state", memory.state);
  const auto orientation = file.read<std::array<double, 4>>("particle.orientation");
  bool fits = orientation.size() == memory.orientation.size();
  const std::size_t count = memory.displacement.size();
  file.read("particle.displacement", memory.displacement);
  fits &= memory.displacement.size() == count;
  if (!fits)
    file.fail("its bonds or particles are those of another body or law");
  for (std::size_t i = 0; i < orientation.size(); ++i) {
    const auto& [w, x, y, z] = orientation[i];
    memory.orientation[i].w = w;
    memory.orientation[i].v = Vec3(x, y, z);
  }
  memory.dissipated = file.read_value<double>("bond.dissipated");
  forces.restore(memory);
}

} // namespace cdem::io
