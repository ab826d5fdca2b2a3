// Tables of a source file that Highway compiles once per target (instruction set), the best one first: `table` of each
// target's namespace. To be included once per source file, in the namespace that encloses these namespaces, where
// `Kernels` is the type of the tables. Targets that Highway does not build for this architecture are left out. The last
// entry is never chosen; it is there because an array must have an element.

constexpr Table<Kernels> tables[] = {
#if HWY_TARGETS & HWY_AVX3_DL
    {HWY_AVX3_DL, Simd::avx512, &N_AVX3_DL::table},
#endif
#if HWY_TARGETS & HWY_AVX3
    {HWY_AVX3, Simd::avx512, &N_AVX3::table},
#endif
#if HWY_TARGETS & HWY_AVX2
    {HWY_AVX2, Simd::avx2, &N_AVX2::table},
#endif
#if HWY_TARGETS & HWY_SSE4
    {HWY_SSE4, Simd::sse4, &N_SSE4::table},
#endif
#if HWY_TARGETS & HWY_NEON
    {HWY_NEON, Simd::neon, &N_NEON::table},
#endif
    {0, Simd::scalar, nullptr},
};
