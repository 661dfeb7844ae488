; SPDX-License-Identifier: MIT
; Division and square root without branches, for the air.
;
; The real64 operations of PTX end in a branch to a slow path for operands near the ends of the
; range, which keeps the compiler from interleaving them. These take the fast path only: the
; hardware's estimate, one iteration of third (division) or second order (root), and a correction
; that gives the rounded result but for rare last bits. Operands must be normal numbers: x/0 is NaN,
; and the root of anything smaller than the smallest normal number is 0 (of a negative one NaN).
; In real32 PTX has such operations of its own, within 2 units of the last place.

declare double @llvm.nvvm.rcp.approx.ftz.d(double)
declare double @llvm.nvvm.rsqrt.approx.ftz.d(double)
declare float @llvm.nvvm.div.full(float, float)
declare float @llvm.nvvm.sqrt.approx.f(float)
declare double @llvm.fma.f64(double, double, double)
declare double @llvm.fabs.f64(double)

define double @brz_divide.f64(double %x, double %y) alwaysinline {
  %r = call double @llvm.nvvm.rcp.approx.ftz.d(double %y)
  %minus = fneg double %y
  %e = call double @llvm.fma.f64(double %minus, double %r, double 1.0)
  %e2 = call double @llvm.fma.f64(double %e, double %e, double %e)
  %inverse = call double @llvm.fma.f64(double %r, double %e2, double %r)
  %q = fmul double %x, %inverse
  %left = call double @llvm.fma.f64(double %minus, double %q, double %x)
  %quotient = call double @llvm.fma.f64(double %left, double %inverse, double %q)
  ret double %quotient
}

define double @brz_root.f64(double %x) alwaysinline {
  %r = call double @llvm.nvvm.rsqrt.approx.ftz.d(double %x)
  %g = fmul double %x, %r
  %h = fmul double %r, 0.5
  %minus_h = fneg double %h
  %e = call double @llvm.fma.f64(double %minus_h, double %g, double 0.5)
  %g1 = call double @llvm.fma.f64(double %g, double %e, double %g)
  %h1 = call double @llvm.fma.f64(double %h, double %e, double %h)
  %minus_g = fneg double %g1
  %left = call double @llvm.fma.f64(double %minus_g, double %g1, double %x)
  %root = call double @llvm.fma.f64(double %left, double %h1, double %g1)
  %size = call double @llvm.fabs.f64(double %x)
  %none = fcmp olt double %size, 0x0010000000000000
  %result = select i1 %none, double 0.0, double %root
  ret double %result
}

define float @brz_divide.f32(float %x, float %y) alwaysinline {
  %quotient = call float @llvm.nvvm.div.full(float %x, float %y)
  ret float %quotient
}

define float @brz_root.f32(float %x) alwaysinline {
  %root = call float @llvm.nvvm.sqrt.approx.f(float %x)
  ret float %root
}
