#include <cdem/cdem.hpp>

#include "units.hpp"

Addresses addresses_in_second() {
  return addresses();
}
