// Powers and sines of several lanes, each the double that the C library gives.
//
// A good C library rounds to the double nearest to the true value, but where that lies within some hundredths of the middle
// between two (glibc, in units in the last place: powers 0.011, sines 0.018). Here the value is worked out to less than 0.01
// units: where that is clear of the middle, its rounding is the library's too; where not, and for all that lies outside the
// tables, the library is asked. Without fused multiply-add it is asked always.
#pragma once

#include <cstdint>
#include <type_traits>

#include "tables.hpp"
#include "work.hpp"

namespace erard::lanes {

template <typename T>
inline constexpr bool kIsFused = !std::is_same_v<typename T::arch_type, xsimd::sse2>;

template <typename T>
using Bits = xsimd::batch<std::uint64_t, typename T::arch_type>;

// xsimd 8 has neither of these two for all instruction sets

/// x y + z, rounded once; of kIsFused alone.
template <typename T>
T fused([[maybe_unused]] const T& x, [[maybe_unused]] const T& y, [[maybe_unused]] const T& z) noexcept {
#ifdef __AVX512F__
  return _mm512_fmadd_pd(x, y, z);
#elif defined(__FMA__)
  return _mm256_fmadd_pd(x, y, z);
#endif
}

/// A line of a table for each lane, its numbers turned into vectors. A load a lane and a transposition; gathers, which do
/// with AVX-512 what one line says, cost 2 % more of the whole step.
template <typename T>
struct Line {
  T number[4];
};
#ifdef __AVX512F__
template <typename T>
Line<T> from_table(const TableLine* table, const Bits<T>& index) noexcept {
  alignas(64) std::uint64_t i[8];
  index.store_aligned(i);
  const auto two = [&](int l) noexcept {  // lines of the lanes l and l + 4
    return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_load_pd(table[i[l]])), _mm256_load_pd(table[i[l + 4]]), 1);
  };
  const __m512d a = two(0), b = two(1), c = two(2), d = two(3);
  const __m512d ab = _mm512_unpacklo_pd(a, b), cd = _mm512_unpacklo_pd(c, d);  // numbers 0 and 2
  const __m512d AB = _mm512_unpackhi_pd(a, b), CD = _mm512_unpackhi_pd(c, d);  // 1 and 3
  const __m512i front = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13),
                back = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
  return {_mm512_permutex2var_pd(ab, front, cd), _mm512_permutex2var_pd(AB, front, CD),
          _mm512_permutex2var_pd(ab, back, cd), _mm512_permutex2var_pd(AB, back, CD)};
}
#elif defined(__AVX2__)
template <typename T>
Line<T> from_table(const TableLine* table, const Bits<T>& index) noexcept {
  alignas(32) std::uint64_t i[4];
  index.store_aligned(i);
  const __m256d a = _mm256_load_pd(table[i[0]]), b = _mm256_load_pd(table[i[1]]);
  const __m256d c = _mm256_load_pd(table[i[2]]), d = _mm256_load_pd(table[i[3]]);
  const __m256d ab = _mm256_unpacklo_pd(a, b), cd = _mm256_unpacklo_pd(c, d);  // numbers 0 and 2
  const __m256d AB = _mm256_unpackhi_pd(a, b), CD = _mm256_unpackhi_pd(c, d);  // 1 and 3
  return {_mm256_permute2f128_pd(ab, cd, 0x20), _mm256_permute2f128_pd(AB, CD, 0x20),
          _mm256_permute2f128_pd(ab, cd, 0x31), _mm256_permute2f128_pd(AB, CD, 0x31)};
}
#endif

/// A number, and in which lanes it is surely that of the C library.
template <typename T>
struct Rounded {
  T value;
  Mask<T> is_sure;
};

/// Rounds first + rest, the rest being less than the first.
/// @param clear  distance from the last double up to which the rounding is sure, in units in the last place
template <typename T>
Rounded<T> round_sum(const T& first, const T& rest, double clear) noexcept {
  const T sum = first + rest, left = rest - (sum - first);
  // of the number below: half as far where the sum is a power of two
  const T below = sum - sum * T(0x1p-53);
  const T unit = xsimd::bitwise_cast<T>(xsimd::bitwise_cast<Bits<T>>(below) & Bits<T>(0x7ff0000000000000)) * T(0x1p-52);
  return {sum, abs(left) < T(clear) * unit};
}

/// Sum of two numbers with what its rounding loses.
template <typename T>
T exact_sum(const T& a, const T& b, T& lost) noexcept {
  const T sum = a + b, b_in = sum - a;
  lost = (a - (sum - b_in)) + (b - b_in);
  return sum;
}

/// ln(x) of a normal number x > 0 as a sum. Absolute error below 2^-64 + |ln x| 2^-70.
template <typename T>
Vector<T> logarithm(const Tables& tables, const T& x) noexcept {
  constexpr double kLn2 = 0x1.62e42fefa3800p-1, kLn2Rest = 0x1.ef35793c76730p-45;
  // x = 2^k z, z in the octave of the table
  const Bits<T> bits = xsimd::bitwise_cast<Bits<T>>(x);
  const Bits<T> shifted = bits - Bits<T>(kLeastBits) + Bits<T>(std::uint64_t{1024} << 52);
  const Bits<T> index = (shifted >> 45) & Bits<T>(Tables::kPoints - 1), octave = shifted >> 52;
  const T k = xsimd::bitwise_cast<T>(octave | Bits<T>(0x4330000000000000)) - T(0x1p52 + 1024);
  const T z = xsimd::bitwise_cast<T>(bits - ((octave - Bits<T>(1024)) << 52));

  // ln z = -ln(inverse) + ln(1 + r),   1 + r + r_rest = z inverse
  const Line<T> point = from_table<T>(tables.logarithm, index);
  const T log = point.number[0], log_rest = point.number[1], inverse = point.number[2];
  const T product = z * inverse, r = product - T(1.0), r_rest = fused(z, inverse, -product);
  const T r2 = r * r, r2_rest = fused(r, r, -r2);
  T tail(-1.0 / 8);  // of the series, from r^3 on
  for (const double c : {1.0 / 7, -1.0 / 6, 1.0 / 5, -1.0 / 4, 1.0 / 3}) tail = fused(tail, r, T(c));
  T lost1, lost2;
  const T whole = fused(k, T(kLn2), log);  // exact
  const T first = exact_sum(exact_sum(whole, r, lost1), T(-0.5) * r2, lost2);
  const T rest =
      fused(k, T(kLn2Rest), log_rest) + lost1 + lost2 - T(0.5) * r2_rest + fused(-r, r_rest, r_rest) + r2 * r * tail;
  return {first, rest};
}

/// e^(first + rest) = 2^(n / 128) e^r.
template <typename T>
Rounded<T> exponential(const Tables& tables, const T& first, const T& rest) noexcept {
  constexpr double kStep = 0x1.62e42fefa3800p-8, kStepRest = 0x1.ef35793c76730p-52, kShift = 0x1.8p52;
  const T shifted = fused(first, T(0x1.71547652b82fep7), T(kShift)), n = shifted - T(kShift);
  const Bits<T> bits = xsimd::bitwise_cast<Bits<T>>(shifted), index = bits & Bits<T>(Tables::kPoints - 1);
  const T r = fused(n, T(-kStep), first) + fused(n, T(-kStepRest), rest);
  T tail(1.0 / 720);
  for (const double c : {1.0 / 120, 1.0 / 24, 1.0 / 6, 1.0 / 2}) tail = fused(tail, r, T(c));
  const T gain = fused(r * r, tail, r);
  const Line<T> point = from_table<T>(tables.exponential, index);
  const Rounded<T> rounded = round_sum(point.number[0], fused(point.number[0], gain, point.number[1]), 0.48);
  const Bits<T> power = ((bits - index) << 45);
  return {xsimd::bitwise_cast<T>(xsimd::bitwise_cast<Bits<T>>(rounded.value) + power), rounded.is_sure};
}

/// base^exponent of one vector of positive numbers.
template <typename T>
Rounded<T> power(const Tables& tables, const T& base, const T& exponent) noexcept {
  const Vector<T> log = logarithm(tables, base);
  const T first = exponent * log.x, rest = fused(exponent, log.x, -first) + exponent * log.y;
  const Rounded<T> rounded = exponential(tables, first, rest);
  return {rounded.value, rounded.is_sure & (base > T(1e-290)) & (base < T(1e290)) & (abs(first) < T(600.0))};
}

/// base^exponent of `count` numbers > 0: all by the tables first, without a branch, so that the CPU works at several vectors
/// at once; then those that are to be asked for.
/// @param base, exponent, result  with room for one vector more
template <typename T>
void raise(const Calls& calls, int count, double* base, double* exponent, double* result) noexcept {
  if constexpr (kIsFused<T>) {
    constexpr int kLanes = Work<T>::kLanes;
    bool is_sure[kMaxPowers + kMaxLanes];
    T(1.0).store_unaligned(base + count);  // beyond the end: anything that is in the tables
    T(1.0).store_unaligned(exponent + count);
    for (int i = 0; i < count; i += kLanes) {
      const Rounded<T> rounded = power(*calls.tables, T::load_unaligned(base + i), T::load_unaligned(exponent + i));
      rounded.value.store_unaligned(result + i);
      rounded.is_sure.store_unaligned(is_sure + i);
    }
    for (int i = 0; i < count; ++i)
      if (!is_sure[i]) result[i] = calls.power(base[i], exponent[i]);
  } else {
    for (int i = 0; i < count; ++i) result[i] = calls.power(base[i], exponent[i]);
  }
}

template <typename T>
void ask_turns(const Calls& calls, const Mask<T>& is_asked, const T& angle, T& cosine, T& sine) noexcept {
  double angles[kMaxLanes], cosines[kMaxLanes], sines[kMaxLanes];
  bool asked[kMaxLanes];
  angle.store_unaligned(angles);
  cosine.store_unaligned(cosines);
  sine.store_unaligned(sines);
  is_asked.store_unaligned(asked);
  for (int l = 0; l < Work<T>::kLanes; ++l)
    if (asked[l]) calls.turn(angles[l], &cosines[l], &sines[l]);
  cosine = T::load_unaligned(cosines);
  sine = T::load_unaligned(sines);
}

/// Sine and cosine of a + d, a the nearest angle of the table:
///   sin = S + C sin d - S (1 - cos d),   cos = C - S sin d - C (1 - cos d)
template <typename T>
void turn_by_table(const Tables& tables, const T& angle, Rounded<T>& cosine, Rounded<T>& sine) noexcept {
  constexpr double kShift = 0x1.8p52;
  const T size = abs(angle), shifted = fused(size, T(Tables::kTurns), T(kShift));
  const Bits<T> index = xsimd::bitwise_cast<Bits<T>>(shifted) & Bits<T>(127);
  const T d = size - (shifted - T(kShift)) * T(1.0 / Tables::kTurns), d2 = d * d;  // exact
  const Line<T> point = from_table<T>(tables.turn, index);
  const T S = point.number[0], S_rest = point.number[1], C = point.number[2], C_rest = point.number[3];
  const T more = d * d2 * fused(d2, fused(d2, T(-1.0 / 5040), T(1.0 / 120)), T(-1.0 / 6));  // sin d - d
  const T less =
      d2 * fused(d2, fused(d2, fused(d2, T(1.0 / 40320), T(-1.0 / 720)), T(1.0 / 24)), T(-0.5));  // cos d - 1
  T lost;
  const T up = C * d, right = -S * d;
  const T first = exact_sum(S, up, lost);
  sine = round_sum(first, lost + fused(C, d, -up) + fused(C_rest, d, S_rest) + fused(C, more, S * less), 0.47);
  const T last = exact_sum(C, right, lost);
  cosine = round_sum(last, lost + fused(-S, d, -right) + fused(-S_rest, d, C_rest) + fused(-S, more, C * less), 0.47);
  sine.value = copysign(sine.value, angle);
}

/// Cosines and sines of several vectors in the lanes wanted; the others are left as they are.
template <typename T>
void turn(const Calls& calls, int count, const Mask<T>& is_wanted, const T* angle, T* cosine, T* sine) noexcept {
  Mask<T> is_asked[kMaxBodies];
  for (int i = 0; i < count; ++i) {
    is_asked[i] = is_wanted;
    if constexpr (kIsFused<T>) {
      const Mask<T> is_covered = is_wanted & (abs(angle[i]) < T(Tables::kMostAngle)) & (abs(angle[i]) > T(1e-100));
      Rounded<T> c, s;
      turn_by_table(*calls.tables, select(is_covered, angle[i], T(0.5)), c, s);
      cosine[i] = select(is_covered, c.value, cosine[i]);
      sine[i] = select(is_covered, s.value, sine[i]);
      is_asked[i] = is_wanted & !(is_covered & c.is_sure & s.is_sure);
    }
  }
  for (int i = 0; i < count; ++i)
    if (any(is_asked[i])) ask_turns(calls, is_asked[i], angle[i], cosine[i], sine[i]);
}

}  // namespace erard::lanes
