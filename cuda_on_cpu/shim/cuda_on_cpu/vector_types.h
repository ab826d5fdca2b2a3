#pragma once

// float4 and its relatives, with CUDA's alignments, and dim3.

#define CUDA_ON_CPU_VECTORS(name, scalar, align_of_2, align_of_4)                     \
    struct name##1 {                                                                  \
        scalar x;                                                                     \
    };                                                                                \
    struct alignas(align_of_2) name##2 {                                              \
        scalar x, y;                                                                  \
    };                                                                                \
    struct name##3 {                                                                  \
        scalar x, y, z;                                                               \
    };                                                                                \
    struct alignas(align_of_4) name##4 {                                              \
        scalar x, y, z, w;                                                            \
    };                                                                                \
    inline name##1 make_##name##1(scalar x) { return {x}; }                           \
    inline name##2 make_##name##2(scalar x, scalar y) { return {x, y}; }              \
    inline name##3 make_##name##3(scalar x, scalar y, scalar z) { return {x, y, z}; } \
    inline name##4 make_##name##4(scalar x, scalar y, scalar z, scalar w) { return {x, y, z, w}; }

CUDA_ON_CPU_VECTORS(char, signed char, 2, 4)
CUDA_ON_CPU_VECTORS(uchar, unsigned char, 2, 4)
CUDA_ON_CPU_VECTORS(short, short, 4, 8)
CUDA_ON_CPU_VECTORS(ushort, unsigned short, 4, 8)
CUDA_ON_CPU_VECTORS(int, int, 8, 16)
CUDA_ON_CPU_VECTORS(uint, unsigned, 8, 16)
CUDA_ON_CPU_VECTORS(longlong, long long, 16, 16)
CUDA_ON_CPU_VECTORS(ulonglong, unsigned long long, 16, 16)
CUDA_ON_CPU_VECTORS(float, float, 8, 16)
CUDA_ON_CPU_VECTORS(double, double, 16, 16)
#undef CUDA_ON_CPU_VECTORS

struct dim3 {
    unsigned x, y, z;
    constexpr dim3(unsigned x_ = 1, unsigned y_ = 1, unsigned z_ = 1) : x(x_), y(y_), z(z_) {}
    constexpr dim3(uint3 v) : x(v.x), y(v.y), z(v.z) {}
    constexpr operator uint3() const { return {x, y, z}; }
};
