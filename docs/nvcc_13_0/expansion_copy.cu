// Smallest program we found that nvcc 13.0 miscompiles, for sm_75 to sm_90a (see ../nvcc_13_0.md):
//
//     nvcc -std=c++20 -O3 -arch=sm_90 -ptx expansion_copy.cu
//
// The kernel stores the sign of each negated list of four numbers. Compiled with nvcc 13.0, it stores 0 for every list;
// on the host, the same functions return the expected signs.

#ifdef __CUDACC__
#include <cstdio>
#define HD __host__ __device__
#else
#define HD
#endif

/// Terms that are not zero; the sign of the last one is the list's sign.
struct Expansion {
    int size = 0;
    double term[4];

    HD Expansion() {}
    HD void append(double value) {
        if (value != 0) term[size++] = value;
    }
    HD int sign() const { return size == 0 ? 0 : term[size - 1] > 0 ? 1 : -1; }
    HD Expansion operator-() const {
        Expansion result;
        for (int i = 0; i < size; ++i) result.append(-term[i]);
        return result;
    }
};

HD inline int opposite_sign(const Expansion& f) { return (-f).sign(); }

/// Returns the negated sign of the last nonzero number among four, or 0 if all are zero.
HD inline int opposite_sign_of_list(const double* numbers) {
    Expansion f;
    for (int k = 0; k < 4; ++k) f.append(numbers[k]);
    return opposite_sign(f);
}

#ifdef __CUDACC__
extern "C" __global__ void opposite_signs(const double* numbers, int n, int* signs) {
    const int i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i < n) signs[i] = opposite_sign_of_list(numbers + 4 * i);
}

int main() {
    const double host[]{1, 2, 3, 4, -1, 0, 0, 0, 0, 0, 0, 5, 0, 0, 0, 0};
    double* numbers;
    int* signs;
    cudaMallocManaged(&numbers, sizeof host);
    cudaMallocManaged(&signs, 4 * sizeof(int));
    for (int k = 0; k < 16; ++k) numbers[k] = host[k];
    opposite_signs<<<1, 4>>>(numbers, 4, signs);
    std::puts(cudaGetErrorString(cudaDeviceSynchronize()));
    for (int i = 0; i < 4; ++i) std::printf("device %d, host %d\n", signs[i], opposite_sign_of_list(host + 4 * i));
}
#endif
