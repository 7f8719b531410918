#pragma once
// Floats side by side, for kernel files only (src/*/*_{portable,avx2,avx512}.cpp). Everything here has internal
// linkage: each instruction path compiles its own copy. Data come in groups of sixteen on every path; a path takes
// `width` of them at a time, as many as a register holds: wider vectors would live in memory.
//
// Node vectors are stored node by node with `node_stride<D>` floats each (the fourth one of a node in 3D is unused), so
// that one load brings all components of a neighbour; kernels turn `width` nodes into one vector per component.
#include <cstddef>
#include <cstdint>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace odpd {

/// Floats per node of a packed node vector.
template <int D>
constexpr int node_stride = D == 2 ? 2 : 4;
/// Nodes per slice.
constexpr int lanes = 16;

namespace {

/// Floats per register.
#if defined(__AVX512F__)
constexpr int width = 16;
#elif defined(__AVX2__)
constexpr int width = 8;
#else
constexpr int width = 4;
#endif

using Floats = float __attribute__((vector_size(4 * width)));
using FloatsAnywhere = float __attribute__((vector_size(4 * width), aligned(4), may_alias));

inline Floats load(const float* p) { return *reinterpret_cast<const FloatsAnywhere*>(p); }
inline void store(float* p, Floats v) { *reinterpret_cast<FloatsAnywhere*>(p) = v; }

/// Sum of the lanes in double, in lane order.
inline double sum_of(Floats v) {
  double s = 0.0;
  for (int l = 0; l < width; ++l) s += static_cast<double>(v[l]);
  return s;
}

template <int D>
struct NodeLanes {
  Floats c[D];
};

#if defined(__AVX512F__)

/// The first nodes at p, each `node_stride` floats.
inline NodeLanes<3> load_nodes3(const float* p) {
  const auto at = [p](int quad) { return _mm512_loadu_ps(p + 16 * quad); };
  // quad k holds nodes 4k..4k+3; in-lane transposition wants {k, 4+k, 8+k, 12+k}.
  const __m512 a = at(0), b = at(1), c = at(2), d = at(3);
  const __m512 ab0 = _mm512_shuffle_f32x4(a, b, 0x44), ab1 = _mm512_shuffle_f32x4(a, b, 0xEE);
  const __m512 cd0 = _mm512_shuffle_f32x4(c, d, 0x44), cd1 = _mm512_shuffle_f32x4(c, d, 0xEE);
  const __m512 m0 = _mm512_shuffle_f32x4(ab0, cd0, 0x88), m1 = _mm512_shuffle_f32x4(ab0, cd0, 0xDD);
  const __m512 m2 = _mm512_shuffle_f32x4(ab1, cd1, 0x88), m3 = _mm512_shuffle_f32x4(ab1, cd1, 0xDD);
  const __m512d lo01 = _mm512_castps_pd(_mm512_unpacklo_ps(m0, m1));
  const __m512d hi01 = _mm512_castps_pd(_mm512_unpackhi_ps(m0, m1));
  const __m512d lo23 = _mm512_castps_pd(_mm512_unpacklo_ps(m2, m3));
  const __m512d hi23 = _mm512_castps_pd(_mm512_unpackhi_ps(m2, m3));
  return {{reinterpret_cast<Floats>(_mm512_unpacklo_pd(lo01, lo23)),
           reinterpret_cast<Floats>(_mm512_unpackhi_pd(lo01, lo23)),
           reinterpret_cast<Floats>(_mm512_unpacklo_pd(hi01, hi23))}};
}

inline NodeLanes<2> load_nodes2(const float* p) {
  const __m512 a = _mm512_loadu_ps(p), b = _mm512_loadu_ps(p + 16);
  const __m512i even = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
  const __m512i odd = _mm512_setr_epi32(1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
  return {{reinterpret_cast<Floats>(_mm512_permutex2var_ps(a, even, b)),
           reinterpret_cast<Floats>(_mm512_permutex2var_ps(a, odd, b))}};
}

// Neighbours by loads that merge 128 (3D) or 64 bits (2D) into a register: faster than hardware gathers.
inline NodeLanes<3> gather_nodes3(const float* p, const std::int32_t* offset) {
  __m512 m[4];
  for (int k = 0; k < 4; ++k) {
    m[k] = _mm512_castps128_ps512(_mm_loadu_ps(p + offset[k]));
    m[k] = _mm512_mask_broadcast_f32x4(m[k], 0x00F0, _mm_loadu_ps(p + offset[4 + k]));
    m[k] = _mm512_mask_broadcast_f32x4(m[k], 0x0F00, _mm_loadu_ps(p + offset[8 + k]));
    m[k] = _mm512_mask_broadcast_f32x4(m[k], 0xF000, _mm_loadu_ps(p + offset[12 + k]));
  }
  const __m512d lo01 = _mm512_castps_pd(_mm512_unpacklo_ps(m[0], m[1]));
  const __m512d hi01 = _mm512_castps_pd(_mm512_unpackhi_ps(m[0], m[1]));
  const __m512d lo23 = _mm512_castps_pd(_mm512_unpacklo_ps(m[2], m[3]));
  const __m512d hi23 = _mm512_castps_pd(_mm512_unpackhi_ps(m[2], m[3]));
  return {{reinterpret_cast<Floats>(_mm512_unpacklo_pd(lo01, lo23)),
           reinterpret_cast<Floats>(_mm512_unpackhi_pd(lo01, lo23)),
           reinterpret_cast<Floats>(_mm512_unpacklo_pd(hi01, hi23))}};
}

inline NodeLanes<2> gather_nodes2(const float* p, const std::int32_t* offset) {
  const auto node = [p, offset](int l) {
    return _mm_castsi128_pd(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p + offset[l])));
  };
  __m512d m[2];
  for (int k = 0; k < 2; ++k) {
    m[k] = _mm512_castpd128_pd512(node(2 * k));
    m[k] = _mm512_mask_broadcastsd_pd(m[k], 0x02, node(2 * k + 1));
    for (int quad = 1; quad < 4; ++quad) {
      m[k] = _mm512_mask_broadcastsd_pd(m[k], static_cast<__mmask8>(1 << (2 * quad)),
                                        node(4 * quad + 2 * k));
      m[k] = _mm512_mask_broadcastsd_pd(m[k], static_cast<__mmask8>(2 << (2 * quad)),
                                        node(4 * quad + 2 * k + 1));
    }
  }
  const __m512 a = _mm512_castpd_ps(m[0]), b = _mm512_castpd_ps(m[1]);
  return {{reinterpret_cast<Floats>(_mm512_shuffle_ps(a, b, 0x88)),
           reinterpret_cast<Floats>(_mm512_shuffle_ps(a, b, 0xDD))}};
}

template <int D>
inline NodeLanes<D> load_nodes(const float* p) {
  if constexpr (D == 2)
    return load_nodes2(p);
  else
    return load_nodes3(p);
}

template <int D>
inline NodeLanes<D> gather_nodes(const float* p, const std::int32_t* offset) {
  if constexpr (D == 2)
    return gather_nodes2(p, offset);
  else
    return gather_nodes3(p, offset);
}

#elif defined(__SSE2__)

#if defined(__AVX2__)
using Register = __m256;
// Nodes k and 4 + k.
template <class Address>
inline Register quads(const Address& node, int k) {
  return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(node(k))),
                              _mm_loadu_ps(node(4 + k)), 1);
}
inline Register low_pairs(Register a, Register b) { return _mm256_unpacklo_ps(a, b); }
inline Register high_pairs(Register a, Register b) { return _mm256_unpackhi_ps(a, b); }
inline Register low_halves(Register a, Register b) { return _mm256_shuffle_ps(a, b, 0x44); }
inline Register high_halves(Register a, Register b) { return _mm256_shuffle_ps(a, b, 0xEE); }
inline Register evens(Register a, Register b) { return _mm256_shuffle_ps(a, b, 0x88); }
inline Register odds(Register a, Register b) { return _mm256_shuffle_ps(a, b, 0xDD); }
#else
using Register = __m128;
template <class Address>
inline Register quads(const Address& node, int k) {
  return _mm_loadu_ps(node(k));
}
inline Register low_pairs(Register a, Register b) { return _mm_unpacklo_ps(a, b); }
inline Register high_pairs(Register a, Register b) { return _mm_unpackhi_ps(a, b); }
inline Register low_halves(Register a, Register b) { return _mm_shuffle_ps(a, b, 0x44); }
inline Register high_halves(Register a, Register b) { return _mm_shuffle_ps(a, b, 0xEE); }
inline Register evens(Register a, Register b) { return _mm_shuffle_ps(a, b, 0x88); }
inline Register odds(Register a, Register b) { return _mm_shuffle_ps(a, b, 0xDD); }
#endif
inline Floats floats(Register v) { return reinterpret_cast<Floats>(v); }

template <class Address>
inline NodeLanes<3> join_nodes3(const Address& node) {
  const Register a = quads(node, 0), b = quads(node, 1), c = quads(node, 2), d = quads(node, 3);
  const Register lo_ab = low_pairs(a, b), hi_ab = high_pairs(a, b);
  const Register lo_cd = low_pairs(c, d), hi_cd = high_pairs(c, d);
  return {{floats(low_halves(lo_ab, lo_cd)), floats(high_halves(lo_ab, lo_cd)),
           floats(low_halves(hi_ab, hi_cd))}};
}

template <class Address>
inline NodeLanes<2> join_nodes2(const Address& node) {
  const auto two = [&node](int l) {
    const auto one = [](const float* p) {
      return _mm_castsi128_pd(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p)));
    };
    return _mm_castpd_ps(_mm_unpacklo_pd(one(node(l)), one(node(l + 1))));
  };
#if defined(__AVX2__)
  const Register ab = _mm256_insertf128_ps(_mm256_castps128_ps256(two(0)), two(4), 1);
  const Register cd = _mm256_insertf128_ps(_mm256_castps128_ps256(two(2)), two(6), 1);
#else
  const Register ab = two(0), cd = two(2);
#endif
  return {{floats(evens(ab, cd)), floats(odds(ab, cd))}};
}

template <int D, class Address>
inline NodeLanes<D> join_nodes(const Address& node) {
  if constexpr (D == 2)
    return join_nodes2(node);
  else
    return join_nodes3(node);
}

template <int D>
inline NodeLanes<D> load_nodes(const float* p) {
  return join_nodes<D>([p](int l) { return p + node_stride<D> * l; });
}

template <int D>
inline NodeLanes<D> gather_nodes(const float* p, const std::int32_t* offset) {
  return join_nodes<D>([p, offset](int l) { return p + offset[l]; });
}

#else

template <int D>
inline NodeLanes<D> load_nodes(const float* p) {
  NodeLanes<D> v;
  for (int c = 0; c < D; ++c)
    for (int l = 0; l < width; ++l) v.c[c][l] = p[node_stride<D> * l + c];
  return v;
}

template <int D>
inline NodeLanes<D> gather_nodes(const float* p, const std::int32_t* offset) {
  NodeLanes<D> v;
  for (int l = 0; l < width; ++l)
    for (int c = 0; c < D; ++c) v.c[c][l] = p[offset[l] + c];
  return v;
}

#endif

/// y += S x, S symmetric: its upper triangle row by row at `s`, sixteen floats per entry.
template <int D>
inline void add_symmetric(const float* s, const NodeLanes<D>& x, NodeLanes<D>& y) {
  for (int row = 0; row < D; ++row)
    for (int col = row; col < D; ++col) {
      const Floats entry = load(s);
      s += lanes;
      y.c[row] += entry * x.c[col];
      if (col != row) y.c[col] += entry * x.c[row];
    }
}

/// Writes `width` nodes; the unused component of a node in 3D becomes zero.
template <int D>
inline void store_nodes(float* p, const NodeLanes<D>& v) {
#if defined(__AVX512F__)
  const __m512 x = reinterpret_cast<__m512>(v.c[0]), y = reinterpret_cast<__m512>(v.c[1]);
  const __m512 lo = _mm512_unpacklo_ps(x, y), hi = _mm512_unpackhi_ps(x, y);
  if constexpr (D == 2) {
    const __m512i first = _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11);
    const __m512i last = _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15);
    const __m512d a = _mm512_castps_pd(lo), b = _mm512_castps_pd(hi);
    _mm512_storeu_pd(p, _mm512_permutex2var_pd(a, first, b));
    _mm512_storeu_pd(p + 16, _mm512_permutex2var_pd(a, last, b));
  } else {
    const __m512 z = reinterpret_cast<__m512>(v.c[D - 1]), zero = _mm512_setzero_ps();
    const __m512d zlo = _mm512_castps_pd(_mm512_unpacklo_ps(z, zero));
    const __m512d zhi = _mm512_castps_pd(_mm512_unpackhi_ps(z, zero));
    const __m512d a = _mm512_castps_pd(lo), b = _mm512_castps_pd(hi);
    // n_k: nodes {k, 4+k, 8+k, 12+k}, one per 128 bits.
    const __m512 n0 = _mm512_castpd_ps(_mm512_unpacklo_pd(a, zlo));
    const __m512 n1 = _mm512_castpd_ps(_mm512_unpackhi_pd(a, zlo));
    const __m512 n2 = _mm512_castpd_ps(_mm512_unpacklo_pd(b, zhi));
    const __m512 n3 = _mm512_castpd_ps(_mm512_unpackhi_pd(b, zhi));
    const __m512 e0 = _mm512_shuffle_f32x4(n0, n1, 0x44), e1 = _mm512_shuffle_f32x4(n2, n3, 0x44);
    const __m512 e2 = _mm512_shuffle_f32x4(n0, n1, 0xEE), e3 = _mm512_shuffle_f32x4(n2, n3, 0xEE);
    _mm512_storeu_ps(p, _mm512_shuffle_f32x4(e0, e1, 0x88));
    _mm512_storeu_ps(p + 16, _mm512_shuffle_f32x4(e0, e1, 0xDD));
    _mm512_storeu_ps(p + 32, _mm512_shuffle_f32x4(e2, e3, 0x88));
    _mm512_storeu_ps(p + 48, _mm512_shuffle_f32x4(e2, e3, 0xDD));
  }
#elif defined(__SSE2__)
  for (int quad = 0; quad < width / 4; ++quad) {
    __m128 part[3] = {};
    for (int c = 0; c < D; ++c)
      __builtin_memcpy(&part[c], reinterpret_cast<const char*>(&v.c[c]) + 16 * quad, 16);
    float* const out = p + 4 * node_stride<D> * quad;
    const __m128 lo = _mm_unpacklo_ps(part[0], part[1]), hi = _mm_unpackhi_ps(part[0], part[1]);
    if constexpr (D == 2) {
      _mm_storeu_ps(out, lo);
      _mm_storeu_ps(out + 4, hi);
    } else {
      const __m128 zlo = _mm_unpacklo_ps(part[2], _mm_setzero_ps());
      const __m128 zhi = _mm_unpackhi_ps(part[2], _mm_setzero_ps());
      _mm_storeu_ps(out, _mm_movelh_ps(lo, zlo));
      _mm_storeu_ps(out + 4, _mm_movehl_ps(zlo, lo));
      _mm_storeu_ps(out + 8, _mm_movelh_ps(hi, zhi));
      _mm_storeu_ps(out + 12, _mm_movehl_ps(zhi, hi));
    }
  }
#else
  for (int l = 0; l < width; ++l) {
    for (int c = 0; c < D; ++c) p[node_stride<D> * l + c] = v.c[c][l];
    for (int c = D; c < node_stride<D>; ++c) p[node_stride<D> * l + c] = 0.0F;
  }
#endif
}

}  // namespace
}  // namespace odpd
