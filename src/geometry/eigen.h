#pragma once

// Eigenvectors of a symmetric 3 x 3 matrix by cyclic Jacobi rotations, as the principal axes of points whose covariance
// the matrix is. Compiled for host and device.
//
// The result does not depend on the order of rotations: axes are sorted by eigenvalue, largest first (ties keep the
// lower index), and the largest component of each is positive. If all eigenvalues are equal within a share `isotropy`
// of the largest, the result is the coordinate axes, so that noise does not rotate the frame of a round cluster from
// call to call.

#include <array>
#include <cmath>

#include "geometry/vec.h"

namespace crumple {

struct SymmetricMatrix {
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
};

struct PrincipalAxes {
    Vec3d axis[3];       ///< eigenvectors of length 1
    double variance[3];  ///< eigenvalue of each axis, largest first
};

CRUMPLE_HD inline PrincipalAxes principal_axes(const SymmetricMatrix& m, double isotropy = 0.02) {
    double a[3][3] = {{m.xx, m.xy, m.xz}, {m.xy, m.yy, m.yz}, {m.xz, m.yz, m.zz}};
    double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int sweep = 0; sweep < 8; ++sweep) {
        for (int p = 0; p < 2; ++p) {
            for (int q = p + 1; q < 3; ++q) {
                if (!(std::abs(a[p][q]) > 1e-18 * (std::abs(a[p][p]) + std::abs(a[q][q])))) continue;
                const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
                const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
                const double c = 1 / std::sqrt(t * t + 1), s = t * c;
                for (int k = 0; k < 3; ++k) {
                    const double kp = a[k][p], kq = a[k][q];
                    a[k][p] = c * kp - s * kq;
                    a[k][q] = s * kp + c * kq;
                }
                for (int k = 0; k < 3; ++k) {
                    const double pk = a[p][k], qk = a[q][k];
                    a[p][k] = c * pk - s * qk;
                    a[q][k] = s * pk + c * qk;
                }
                for (int k = 0; k < 3; ++k) {
                    const double kp = v[k][p], kq = v[k][q];
                    v[k][p] = c * kp - s * kq;
                    v[k][q] = s * kp + c * kq;
                }
            }
        }
    }
    int order[3] = {0, 1, 2};
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2 - i; ++j)
            if (a[order[j]][order[j]] < a[order[j + 1]][order[j + 1]]) {
                const int swap = order[j];
                order[j] = order[j + 1];
                order[j + 1] = swap;
            }
    PrincipalAxes result;
    const double most = a[order[0]][order[0]], least = a[order[2]][order[2]];
    const bool isotropic = !(most - least > isotropy * most);
    for (int i = 0; i < 3; ++i) {
        const int k = order[i];
        result.variance[i] = a[k][k];
        Vec3d e{v[0][k], v[1][k], v[2][k]};
        const double reach = largest(abs(e));
        const double lead = std::abs(e.x) == reach ? e.x : std::abs(e.y) == reach ? e.y : e.z;
        if (lead < 0) e = -1.0 * e;
        if (isotropic) e = {i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0, i == 2 ? 1.0 : 0.0};
        result.axis[i] = e;
    }
    return result;
}

}  // namespace crumple
