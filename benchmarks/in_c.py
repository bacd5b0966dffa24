"""The scheme of the kernel in C, by hand, for a device with a Dahl bristle and viscous friction.

Scalar, and with a lane for each of several simulations: arrays of each quantity, worked on by
`omp simd`, both branches of the exact step computed and one taken, exp by its series as the
package's lanes have it. Compiled on the spot; not part of the package.
"""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from pathlib import Path

import numpy as np

#: sums keep their order. Without -fno-trapping-math gcc works on one lane after the other; with
#: -ffast-math, which reorders sums, lanes took half the time again
OPTIONS = (
    "-O3",
    "-march=native",
    "-fopenmp-simd",
    "-shared",
    "-fPIC",
    "-fno-math-errno",
    "-fno-trapping-math",
)

SCALAR = r"""
#include <math.h>
static void phi(double z, double *e, double *p1, double *p2, double *p3) {
  if (fabs(z) < 1.0) {
    double s = 0.0, c = 1.0 / 1307674368000.0;
    static const double f[12] = {1.0/6, 1.0/24, 1.0/120, 1.0/720, 1.0/5040, 1.0/40320, 1.0/362880,
      1.0/3628800, 1.0/39916800, 1.0/479001600, 1.0/6227020800.0, 1.0/87178291200.0};
    s = c;
    for (int k = 11; k >= 0; k--) s = f[k] + z * s;
    *p3 = s; *p2 = z * s + 0.5; *p1 = z * *p2 + 1.0; *e = z * *p1 + 1.0;
  } else {
    *e = exp(z); *p1 = (*e - 1) / z; *p2 = (*p1 - 1) / z; *p3 = (*p2 - 0.5) / z;
  }
}
void simulate(long steps, long inner, double h, const double *p, const double *force, double *out) {
  const double m = p[0], level = p[1], stiffness = p[2], damping = p[3];
  double x = 0, v = 0, z = 0;
  for (long j = 0; j <= steps; j++) {
    if (j % inner == 0) out[j / inner] = x;
    if (j == steps) break;
    double u0 = force[2*j], u1 = force[2*j+1], u2 = force[2*j+2];
    double a = -stiffness * fabs(v) / level, e, p1, p2, p3;
    phi(0.5 * h * a, &e, &p1, &p2, &p3);
    double q1 = 0.5*(e+1)*p1, q2 = 0.25*(p1*p1+2*p2), q3 = 0.125*(p1*p2+p2+2*p3);
    double w0 = q1-3*q2+4*q3, w1 = 2*q2-4*q3, w3 = 4*q3-q2, g = 0.5*h*p1;
#define RATE(V, Z, U) ((U - damping*(V) - stiffness*(Z)) / m)
#define REST(V, Z) ((V) - stiffness*fabs(V)/level*(Z) - a*(Z))
    double a0 = RATE(v, z, u0), n0 = REST(v, z);
    double v1 = v + 0.5*h*a0, z1 = e*z + g*n0, a1 = RATE(v1, z1, u1), n1 = REST(v1, z1);
    double v2 = v + 0.5*h*a1, z2 = e*z + g*n1, a2 = RATE(v2, z2, u1), n2 = REST(v2, z2);
    double v3 = v + h*a2, z3 = e*z1 + g*(2*n2-n0), a3 = RATE(v3, z3, u2), n3 = REST(v3, z3);
    x += h/6*(v + 2*(v1+v2) + v3);
    v += h/6*(a0 + 2*(a1+a2) + a3);
    z = e*e*z + h*(w0*n0 + w1*(n1+n2) + w3*n3);
  }
}
"""

#: MANY: number of lanes
SIMD = r"""
#include <math.h>
#include <stdint.h>
#include <string.h>
#define LANES MANY
#define INLINE static inline __attribute__((always_inline))
/* exp by its series on abs(r) < 0.35, ln 2 in two parts (Cody, Waite) */
INLINE double exponential(double x) {
  x = x < -708.0 ? -708.0 : x > 709.0 ? 709.0 : x;
  double n = floor(x * 1.4426950408889634 + 0.5);
  double r = (x - n * 6.93145751953125e-1) - n * 1.42860682030941723212e-6;
  double s = 1.0/6227020800.0;
  s = s*r + 1.0/479001600; s = s*r + 1.0/39916800; s = s*r + 1.0/3628800; s = s*r + 1.0/362880;
  s = s*r + 1.0/40320; s = s*r + 1.0/5040; s = s*r + 1.0/720; s = s*r + 1.0/120; s = s*r + 1.0/24;
  s = s*r + 1.0/6; s = s*r + 0.5; s = s*r + 1.0; s = s*r + 1.0;
  int64_t bits = ((int64_t)(int32_t)n + 1023) << 52;
  double power;
  memcpy(&power, &bits, 8);
  return s * power;
}
INLINE void phi(double z, double *e, double *p1, double *p2, double *p3) {
  double s = 1.0/1307674368000.0;
  s = s*z + 1.0/87178291200.0; s = s*z + 1.0/6227020800.0; s = s*z + 1.0/479001600;
  s = s*z + 1.0/39916800; s = s*z + 1.0/3628800; s = s*z + 1.0/362880; s = s*z + 1.0/40320;
  s = s*z + 1.0/5040; s = s*z + 1.0/720; s = s*z + 1.0/120; s = s*z + 1.0/24; s = s*z + 1.0/6;
  double s2 = z*s + 0.5, s1 = z*s2 + 1.0, s0 = z*s1 + 1.0;
  int is_near = fabs(z) < 1.0;
  double w = is_near ? 1.0 : z, inverse = 1.0 / w;
  double l0 = exponential(w), l1 = (l0 - 1)*inverse, l2 = (l1 - 1)*inverse;
  double l3 = (l2 - 0.5)*inverse;
  *e = is_near ? s0 : l0; *p1 = is_near ? s1 : l1; *p2 = is_near ? s2 : l2;
  *p3 = is_near ? s : l3;
}
void simulate(long steps, long inner, double h, const double *restrict p,
              const double *restrict force, double *restrict out, double *restrict squares) {
  double x[LANES] = {0}, v[LANES] = {0}, z[LANES] = {0};
  for (int i = 0; i < LANES; i++) squares[i] = 0;
  for (long j = 0; j <= steps; j++) {
    if (j % inner == 0) {
      #pragma omp simd
      for (int i = 0; i < LANES; i++) {
        out[j / inner * LANES + i] = x[i];
        squares[i] += x[i] * x[i];
      }
    }
    if (j == steps) break;
    double u0 = force[2*j], u1 = force[2*j+1], u2 = force[2*j+2];
    #pragma omp simd
    for (int i = 0; i < LANES; i++) {
      double m = p[i], level = p[LANES+i], stiffness = p[2*LANES+i], damping = p[3*LANES+i];
      double X = x[i], V = v[i], Z = z[i];
      double a = -stiffness * fabs(V) / level, e, p1, p2, p3;
      phi(0.5 * h * a, &e, &p1, &p2, &p3);
      double q1 = 0.5*(e+1)*p1, q2 = 0.25*(p1*p1+2*p2), q3 = 0.125*(p1*p2+p2+2*p3);
      double w0 = q1-3*q2+4*q3, w1 = 2*q2-4*q3, w3 = 4*q3-q2, g = 0.5*h*p1;
#define RATE(V, Z, U) ((U - damping*(V) - stiffness*(Z)) / m)
#define REST(V, Z) ((V) - stiffness*fabs(V)/level*(Z) - a*(Z))
      double a0 = RATE(V, Z, u0), n0 = REST(V, Z);
      double v1 = V + 0.5*h*a0, z1 = e*Z + g*n0, a1 = RATE(v1, z1, u1), n1 = REST(v1, z1);
      double v2 = V + 0.5*h*a1, z2 = e*Z + g*n1, a2 = RATE(v2, z2, u1), n2 = REST(v2, z2);
      double v3 = V + h*a2, z3 = e*z1 + g*(2*n2-n0), a3 = RATE(v3, z3, u2), n3 = REST(v3, z3);
      x[i] = X + h/6*(V + 2*(v1+v2) + v3);
      v[i] = V + h/6*(a0 + 2*(a1+a2) + a3);
      z[i] = e*e*Z + h*(w0*n0 + w1*(n1+n2) + w3*n3);
    }
  }
}
"""


def compiled(source: str, folder: Path, name: str) -> ctypes.CDLL | None:
    """The library of that source, or None where there is no gcc."""
    if shutil.which("gcc") is None:
        return None
    (folder / f"{name}.c").write_text(source)
    library = folder / f"{name}.so"
    subprocess.run(["gcc", *OPTIONS, "-o", library, folder / f"{name}.c", "-lm"], check=True)
    return ctypes.CDLL(str(library))


def pointer(array: np.ndarray) -> ctypes._Pointer:  # type: ignore[type-arg]
    """To the numbers of an array, as C takes it."""
    return array.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
