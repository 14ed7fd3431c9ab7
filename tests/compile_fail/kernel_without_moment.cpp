// A kernel without its first moment along a line is refused, and what it must do is named.
//
// expect: IntegratesAlongLines
// expect: kernel\.first_moment\(begin, end, square\)

#include <cdem/stress/kernels.hpp>

struct Ball {
  double reach() const { return 1; }
  double density(double) const { return 0.2387; }
  double integral(double begin, double end, double) const { return 0.2387 * (end - begin); }
#ifdef CDEM_REPAIRED
  double first_moment(double begin, double end, double) const {
    return 0.2387 * (end * end - begin * begin) / 2;
  }
#endif
};

static_assert(cdem::stress::SmoothingKernel<Ball>); // refused here
