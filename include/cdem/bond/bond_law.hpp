#pragma once

/// @file
/// What a bond law is: from two particles at rest to how their bond resists.
///
/// There are three ways to write one, each a concept here; docs/how_to/write_a_bond_law.md shows them.
///
///     linear  stiffness(geometry)                  ChannelStiffness, or the 12x12 matrix of the bond
///     force   load(prepared, deformation)          ChannelLoad, and energy(prepared, deformation)
///     energy  energy(prepared, deformation)        a template of its Real: forces and tangent by differentiation
///
/// `prepared` is what the law's own prepare(geometry) returns, kept for each bond; the geometry itself where there is
/// none. A law with a memory declares `State`, takes `const State&` last, and changes it in update(prepared,
/// deformation, State&), which is called before load and energy.

#include <cdem/bond/detail/named_members.hpp>
#include <cdem/core/dual.hpp>
#include <cdem/core/types.hpp>
#include <cdem/network/bond_network.hpp>
#include <cdem/particles/particle_set.hpp>

#include <Eigen/Geometry> // cross product

#include <concepts>
#include <cstdint>
#include <type_traits>
#include <utility>

namespace cdem::bond {

/// A bond at rest, as a law sees it.
struct BondGeometry {
  Vec3 direction;           ///< unit vector n from the first particle to the second
  double length = 0;        ///< L, distance of the centres, m
  double radius_first = 0;  ///< R_i, m
  double radius_second = 0; ///< R_j, m
  PhaseIndex phase_first = 0;
  PhaseIndex phase_second = 0;
  ParticleIndex first = 0;  ///< number of the first particle
  ParticleIndex second = 0; ///< number of the second particle
};

/// Geometry of bond `b`.
inline BondGeometry geometry_of(BondIndex b, const particles::ParticleSet& particles,
                                const network::BondNetwork& network) {
  const ParticleIndex i = network.first[b], j = network.second[b];
  const double length = network.branch[b].norm();
  return {network.branch[b] / length,
          length,
          particles.radius[i],
          particles.radius[j],
          particles.phase[i],
          particles.phase[j],
          i,
          j};
}

/// The four stiffnesses of a bond whose force is linear in its ends' small motion.
///
/// They multiply the four independent deformations of a bond, see load_of(). None may be negative.
struct ChannelStiffness {
  double normal = 0;     ///< K_n, N/m: stretch along n
  double tangential = 0; ///< K_t, N/m: shear across n
  double torsion = 0;    ///< S_n, N m: twist about n
  double bending = 0;    ///< E_mu I / L, N m: difference of the ends' rotations across n
};

/// Force and moments that a bond exerts on its two ends.
struct BondLoad {
  Vec3 force;         ///< N, on the first particle; the second gets the opposite
  Vec3 moment_first;  ///< N m, on the first particle, about its centre
  Vec3 moment_second; ///< N m, on the second particle, about its centre

  /// M, N m: what the first half of the bond takes half-way between the ends.
  Vec3 middle_moment() const { return 0.5 * (moment_first - moment_second); }
};

/// Two components across a bond, along t and b of its local frame (n, t, b), [L17] section 2.2.
template <class Real = double>
struct Across {
  Real t{}, b{};
  [[gnu::always_inline]] Real squared() const { return t * t + b * b; }
};

/// How a bond is deformed, in its local frame. Rigid motions give zero.
///
/// The frame is fixed to the bond at rest, or to the mean rotation of its ends where rotations are finite; t and b are
/// any two directions across n, the same all the time.
template <class Real = double>
struct Deformation {
  Real stretch{};       ///< m, along n; above 0 in tension
  Across<Real> shear{}; ///< m
  Real twist{};         ///< rad, about n
  Across<Real> bend{};  ///< rad: difference of the ends' rotations across n
};

/// What a bond does against its deformation: the derivatives of its energy by Deformation's members where it has one.
///
///     F on the first particle = normal n + tangential,   M in the middle of the bond = torsion n + bending
///     M on i = M + (L/2) n x F,  M on j = -M + (L/2) n x F
///
/// Forces and moments balance whatever the numbers.
template <class Real = double>
struct ChannelLoad {
  Real normal{};             ///< F_n, N; above 0 pulls the ends together
  Across<Real> tangential{}; ///< F_t, F_b, N
  Real torsion{};            ///< M_n, N m
  Across<Real> bending{};    ///< N m
};

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Matrix12 = Eigen::Matrix<double, 12, 12>;

/// The state of a law without a memory.
struct NoState {};

namespace detail {
template <class L>
struct StateOf {
  using type = NoState;
};
template <class L>
requires requires {
  typename L::State;
}
struct StateOf<L> {
  using type = typename L::State;
};
} // namespace detail

/// What a law remembers of each bond: `L::State`, or nothing.
template <class L>
using StateOf = typename detail::StateOf<L>::type;

/// `L::State` is declared, and is not NoState: the law has a memory of each bond.
template <class L>
concept HasState = !std::same_as<StateOf<L>, NoState>;

/// `law.prepare(geometry)` computes once what load and energy need of a bond at rest. Not needed, saves time.
template <class L>
concept PreparesBonds = requires(const L& law, const BondGeometry& geometry) {
  law.prepare(geometry);
};

namespace detail {
template <class L>
struct PreparedOf {
  using type = BondGeometry;
};
template <PreparesBonds L>
struct PreparedOf<L> {
  using type =
      std::remove_cvref_t<decltype(std::declval<const L&>().prepare(std::declval<const BondGeometry&>()))>;
};
} // namespace detail

/// What a law is given of a bond at rest: what its prepare() returns, else the BondGeometry.
template <class L>
using PreparedOf = typename detail::PreparedOf<L>::type;

/// The number type with which energies are differentiated by the six components of the deformation.
using Differentiable = core::Dual<double, 6>;

/// `law.validate(particles)` throws core::InvalidInput where a particle's phase has no material.
template <class L>
concept ValidatesParticles = requires(const L& law, const particles::ParticleSet& particles) {
  law.validate(particles);
};

/// The same type. Compilers say less of it than of std::same_as where it fails.
template <class T, class U>
concept Is = std::is_same_v<T, U>;

/// What a linear law may say of a bond: its ChannelStiffness, or its 12x12 stiffness in (u_i, th_i, u_j, th_j), rows and
/// columns x, y, z.
template <class K>
concept ChannelsOrMatrix12 = std::is_same_v<K, ChannelStiffness> || std::is_same_v<K, Matrix12>;

/// `law.stiffness(geometry)` gives the bond's ChannelStiffness or Matrix12.
template <class L>
concept GivesStiffness = requires(const L& law, const BondGeometry& geometry) {
  { law.stiffness(geometry) } -> ChannelsOrMatrix12;
};

/// `law.stiffness(geometry)` gives the bond's ChannelStiffness.
template <class L>
concept GivesChannelStiffness = requires(const L& law, const BondGeometry& geometry) {
  { law.stiffness(geometry) } -> Is<ChannelStiffness>;
};

/// `law.stiffness(geometry)` gives the bond's 12x12 stiffness.
template <class L>
concept GivesBlockStiffness = requires(const L& law, const BondGeometry& geometry) {
  { law.stiffness(geometry) } -> Is<Matrix12>;
};

/// `law.load(prepared, deformation)` gives a ChannelLoad.
template <class L>
concept GivesLoadOfDeformation = requires(const L& law, const PreparedOf<L>& prepared,
                                          const Deformation<>& deformation) {
  { law.load(prepared, deformation) } -> Is<ChannelLoad<>>;
};

/// `law.load(prepared, deformation, state)` gives a ChannelLoad and leaves the state alone.
template <class L>
concept GivesLoadOfState = requires(const L& law, const PreparedOf<L>& prepared,
                                    const Deformation<>& deformation, const StateOf<L>& state) {
  { law.load(prepared, deformation, state) } -> Is<ChannelLoad<>>;
};

/// `law.load` gives a ChannelLoad; where there is a State, it is told.
template <class L>
concept GivesLoad = (!HasState<L> && GivesLoadOfDeformation<L>) || GivesLoadOfState<L>;

/// `law.energy(prepared, deformation)` gives what is stored, J, for a deformation of `Real`.
template <class L, class Real>
concept GivesEnergyOfDeformation = requires(const L& law, const PreparedOf<L>& prepared,
                                            const Deformation<Real>& deformation) {
  { law.energy(prepared, deformation) } -> Is<Real>;
};

/// `law.energy(prepared, deformation, state)` gives what is stored, J, for a deformation of `Real`.
template <class L, class Real>
concept GivesEnergyOfState = requires(const L& law, const PreparedOf<L>& prepared,
                                      const Deformation<Real>& deformation, const StateOf<L>& state) {
  { law.energy(prepared, deformation, state) } -> Is<Real>;
};

/// `law.energy` gives what is stored for a deformation of `Real`; where there is a State, it is told.
template <class L, class Real>
concept GivesEnergy = (!HasState<L> && GivesEnergyOfDeformation<L, Real>) || GivesEnergyOfState<L, Real>;

/// `L::State` can be copied as bytes, as arrays and checkpoints of it are.
template <class L>
concept StateIsTriviallyCopyable = std::is_trivially_copyable_v<StateOf<L>>;

/// `L::State{}` is the state of a bond that nothing happened to.
template <class L>
concept StateIsDefaultConstructible = std::is_default_constructible_v<StateOf<L>>;

/// `law.update(prepared, deformation, state)` lets the state follow the deformation.
template <class L>
concept UpdatesState = requires(const L& law, const PreparedOf<L>& prepared, const Deformation<>& deformation,
                                StateOf<L>& state) {
  law.update(prepared, deformation, state);
};

/// `law.update` takes its state as `State&`: by value or as const, what it learns would be lost.
template <class L>
concept UpdatesStateByReference =
    !requires(const L& law, const PreparedOf<L>& prepared, const Deformation<>& deformation) {
  law.update(prepared, deformation, StateOf<L>{}); // a temporary does for all but State&
};

/// A law without a memory, or one that keeps it.
template <class L>
concept KeepsItsState = !HasState<L> || (StateIsTriviallyCopyable<L> && StateIsDefaultConstructible<L> &&
                                         UpdatesState<L> && UpdatesStateByReference<L>);

/// A law whose force is linear in the small motion of the bond's ends. Models: Beam, Spring, TimoshenkoBeam.
template <class L>
concept LinearLaw = GivesStiffness<L>;

/// A law that gives its load and the energy it stores.
template <class L>
concept ForceLaw = GivesLoad<L> && GivesEnergy<L, double> && KeepsItsState<L>;

/// A law that gives its energy alone, as a template of the number type.
template <class L>
concept EnergyLaw = GivesEnergy<L, double> && GivesEnergy<L, Differentiable> && KeepsItsState<L>;

/// `law.section_radius(geometry)` in m: the bond is a beam or bar of circular section. Stress criteria need it.
template <class L>
concept GivesSectionRadius = requires(const L& law, const BondGeometry& geometry) {
  { law.section_radius(geometry) } -> std::same_as<double>;
};

/// `L::finite_rotation` is true: the bond's frame turns with its ends, however far.
template <class L>
concept TurnsWithItsEnds = requires {
  requires L::finite_rotation;
};

namespace detail {

enum class LawKind : std::uint8_t { none, linear, force, energy };

/// Whether L is a law of some kind with all its parts.
template <class L>
inline constexpr bool is_whole = LinearLaw<L> || ForceLaw<L> || EnergyLaw<L>;

/// The kind that a class is, or that its author meant it to be.
template <class L>
consteval LawKind kind_of() {
  if constexpr (LinearLaw<L>)
    return LawKind::linear;
  else if constexpr (ForceLaw<L>)
    return LawKind::force;
  else if constexpr (EnergyLaw<L>)
    return LawKind::energy;
  else
    return NamesStiffness<L> ? LawKind::linear
           : NamesLoad<L>    ? LawKind::force
           : NamesEnergy<L>  ? LawKind::energy
                             : LawKind::none;
}

/// A law of every kind, never run: stands in a concept where there is nothing to ask of the law in question.
struct AnyLaw {
  struct State {};
  ChannelStiffness stiffness(const BondGeometry&) const;
  ChannelLoad<> load(const BondGeometry&, const Deformation<>&) const;
  ChannelLoad<> load(const BondGeometry&, const Deformation<>&, const State&) const;
  template <class Real>
  Real energy(const BondGeometry&, const Deformation<Real>&) const;
  template <class Real>
  Real energy(const BondGeometry&, const Deformation<Real>&, const State&) const;
  BondGeometry prepare(const BondGeometry&) const;
  void update(const BondGeometry&, const Deformation<>&, State&) const;
};

// The law, where it lacks something and the question concerns it: what a concept then asks of it is asked of no other,
// and the compiler's message has no "or". GCC does not go into the halves of a disjunction.
template <class L, bool asked>
using Asked = std::conditional_t<!is_whole<L> && asked, L, AnyLaw>;
template <class L>
using IfLinear = Asked<L, kind_of<L>() == LawKind::linear>;
template <class L>
using IfForce = Asked<L, kind_of<L>() == LawKind::force && !HasState<L>>;
template <class L>
using IfForceWithState = Asked<L, kind_of<L>() == LawKind::force && HasState<L>>;
template <class L>
using IfEnergy = Asked<L, kind_of<L>() == LawKind::energy && !HasState<L>>;
template <class L>
using IfEnergyWithState = Asked<L, kind_of<L>() == LawKind::energy && HasState<L>>;
template <class L>
using IfPrepares = Asked<L, NamesPrepare<L>>;
template <class L>
using IfUpdates =
    std::conditional_t<NamesUpdate<L>, L, AnyLaw>; // a State left out would be a law without memory
template <class L>
using IfHasState = Asked<L, HasState<L>>;

} // namespace detail

/// The class names stiffness (a linear law), load (a force law) or energy (an energy law).
template <class L>
concept NamesStiffnessLoadOrEnergy = detail::kind_of<L>()
!= detail::LawKind::none;

/// `L::State` is declared.
template <class L>
concept DeclaresState = requires {
  typename L::State;
};

/// `law.energy(prepared, deformation)` is a template of its Real: forces are differentiated with core::Dual.
template <class L>
concept EnergyIsDifferentiable = requires(const L& law, const PreparedOf<L>& prepared,
                                          const Deformation<Differentiable>& deformation) {
  { law.energy(prepared, deformation) } -> Is<Differentiable>;
};
/// The same of `law.energy(prepared, deformation, state)`.
template <class L>
concept EnergyOfStateIsDifferentiable = requires(const L& law, const PreparedOf<L>& prepared,
                                                 const Deformation<Differentiable>& deformation,
                                                 const StateOf<L>& state) {
  { law.energy(prepared, deformation, state) } -> Is<Differentiable>;
};

/// A bond law: a LinearLaw, a ForceLaw or an EnergyLaw. Models: Beam, Spring, and the laws that wrap another.
///
/// A class that is none of them is asked for the parts of the kind that its author named, one by one, so that the
/// message says what is missing.
template <class L>
concept BondLaw =
    std::copy_constructible<L> && ValidatesParticles<L> && NamesStiffnessLoadOrEnergy<L> &&
    // what it names beside its kind
    PreparesBonds<detail::IfPrepares<L>> && DeclaresState<detail::IfUpdates<L>> &&
    StateIsTriviallyCopyable<detail::IfHasState<L>> && StateIsDefaultConstructible<detail::IfHasState<L>> &&
    UpdatesState<detail::IfHasState<L>> && UpdatesStateByReference<detail::IfHasState<L>> &&
    // its kind
    GivesStiffness<detail::IfLinear<L>> && GivesLoadOfDeformation<detail::IfForce<L>> &&
    GivesLoadOfState<detail::IfForceWithState<L>> && GivesEnergyOfDeformation < detail::IfForce<L>,
double > &&GivesEnergyOfState<detail::IfForceWithState<L>, double>&& GivesEnergyOfDeformation<
             detail::IfEnergy<L>, double>&& GivesEnergyOfState<detail::IfEnergyWithState<L>, double>&&
             EnergyIsDifferentiable<detail::IfEnergy<L>>&&
                 EnergyOfStateIsDifferentiable<detail::IfEnergyWithState<L>>;

/// Deformation of a bond in small motion, [L17] section 2.2 in frame-free form.
///
/// With th = (th_i + th_j)/2:  slip = u_j - u_i - L th x n,  turn = th_j - th_i. Rigid motions give zero for
/// both.
struct BondDeformation {
  Vec3 slip; ///< m: stretch along n, shear across n
  Vec3 turn; ///< rad: twist along n, bend across n
};

/// Deformation from the displacement u and the rotation th of the bond's ends.
template <class Spatial>
BondDeformation deformation_of(const Vec3& direction, double length, const Spatial& first,
                               const Spatial& second) {
  const Vec3 mean_rotation = 0.5 * (first.angular() + second.angular());
  return {second.linear() - first.linear() - length * mean_rotation.cross(direction),
          second.angular() - first.angular()};
}

/// Load of a linear bond, [L17] section 2.2 in frame-free form.
///
///     F on i =  K_n g_n n + K_t g_t,  F on j = -F             g: slip
///     M      =  S_n d_n n + (E_mu I/L) d_t                    d: turn
///     M on i =  M + (L/2) n x F,      M on j = -M + (L/2) n x F
///
/// Equal to the 12x12 matrix of the Euler–Bernoulli beam when the stiffnesses are the beam's. The couple
/// (L/2) n x F balances the moment of the two opposite forces.
inline BondLoad load_of(const ChannelStiffness& stiffness, const Vec3& direction, double length,
                        const BondDeformation& deformation) {
  const auto channels = [&](double along, double across, const Vec3& v) -> Vec3 {
    return across * v + ((along - across) * direction.dot(v)) * direction;
  };
  const Vec3 force = channels(stiffness.normal, stiffness.tangential, deformation.slip);
  const Vec3 moment = channels(stiffness.torsion, stiffness.bending, deformation.turn);
  const Vec3 couple = 0.5 * length * direction.cross(force);
  return {force, moment + couple, couple - moment};
}

/// Elastic energy of a linear bond, J: half of each stiffness times its deformation squared.
inline double energy_of(const ChannelStiffness& stiffness, const Vec3& direction,
                        const BondDeformation& deformation) {
  const auto channels = [&](double along, double across, const Vec3& v) {
    const double normal = direction.dot(v);
    return 0.5 * (across * v.squaredNorm() + (along - across) * normal * normal);
  };
  return channels(stiffness.normal, stiffness.tangential, deformation.slip) +
         channels(stiffness.torsion, stiffness.bending, deformation.turn);
}

} // namespace cdem::bond
