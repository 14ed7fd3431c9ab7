#pragma once

/// @file
/// What cdem throws, and the checks that throw it. Every message names the value and what is accepted.

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>

namespace cdem::core {

/// A value the caller gave is not accepted. what() reads "<name> = <value> is not accepted: <accepted>".
class InvalidInput : public std::invalid_argument {
public:
  using std::invalid_argument::invalid_argument;
};

/// A computation could not reach what was asked (a density, a tolerance, a stable step).
class NotReached : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// A file could not be read or written; the message names the file and the reason.
class FileError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// The user asked to stop (Ctrl-C). The state the caller holds is that of the last whole step.
class Interrupted : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// Text of a value for a message, with enough digits to recognise it.
template <class Value>
std::string to_text(const Value& value) {
  std::ostringstream out;
  out.precision(12);
  if constexpr (std::is_same_v<Value, unsigned char> || std::is_same_v<Value, signed char>)
    out << static_cast<int>(value);
  else
    out << value;
  return out.str();
}

/// Throws InvalidInput: "<name> = <value> is not accepted: <accepted>".
template <class Value>
[[noreturn]] void reject(std::string_view name, const Value& value, std::string_view accepted) {
  throw InvalidInput(std::string(name) + " = " + to_text(value) +
                     " is not accepted: " + std::string(accepted));
}

/// Throws InvalidInput unless `condition`; see reject().
template <class Value>
void expect(bool condition, std::string_view name, const Value& value, std::string_view accepted) {
  if (!condition) [[unlikely]]
    reject(name, value, accepted);
}

/// Throws InvalidInput unless `value` is a finite number above zero.
inline void expect_positive(double value, std::string_view name, std::string_view unit = "") {
  if (!(std::isfinite(value) && value > 0)) [[unlikely]]
    reject(name, value,
           std::string("a finite number above 0") + (unit.empty() ? "" : " ") + std::string(unit) +
               " is expected");
}

/// Throws InvalidInput unless `value` is a finite number, zero or above.
inline void expect_not_negative(double value, std::string_view name, std::string_view unit = "") {
  if (!(std::isfinite(value) && value >= 0)) [[unlikely]]
    reject(name, value,
           std::string("a finite number, 0 or above") + (unit.empty() ? "" : ", in ") + std::string(unit) +
               " is expected");
}

/// Throws InvalidInput unless `value` is finite (neither NaN nor infinite).
inline void expect_finite(double value, std::string_view name) {
  if (!std::isfinite(value)) [[unlikely]]
    reject(name, value, "a finite number is expected");
}

} // namespace cdem::core
