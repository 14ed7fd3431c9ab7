#pragma once

/// @file
/// Which members a class names, whatever their types: what its author meant it to be, and so what is missing.

#include <type_traits>

namespace cdem::bond::detail {

/// The names looked for. A class derived from this and from another that has the name too cannot say which is meant.
struct LawNames {
  int stiffness, load, energy, prepare, update;
};
struct NoNames {};
template <class L>
struct WithLawNames : std::conditional_t<std::is_class_v<L> && !std::is_final_v<L>, L, NoNames>, LawNames {};

// The second half serves classes that are final, of which nothing can be derived: overloads and templates are not seen.
template <class L>
concept NamesStiffness = !requires {
  &WithLawNames<L>::stiffness;
}
|| requires {
  &L::stiffness;
};
template <class L>
concept NamesLoad = !requires {
  &WithLawNames<L>::load;
}
|| requires {
  &L::load;
};
template <class L>
concept NamesEnergy = !requires {
  &WithLawNames<L>::energy;
}
|| requires {
  &L::energy;
}
|| requires {
  &L::template energy<double>;
};
template <class L>
concept NamesPrepare = !requires {
  &WithLawNames<L>::prepare;
}
|| requires {
  &L::prepare;
};
template <class L>
concept NamesUpdate = !requires {
  &WithLawNames<L>::update;
}
|| requires {
  &L::update;
};

} // namespace cdem::bond::detail
