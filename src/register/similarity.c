/* SPDX-License-Identifier: Apache-2.0
 *
 * From the frame of reference in which cameras were found (structure from motion knows no scale) to
 * the mesh's, by points known in both: Horn, "Closed-form solution of absolute orientation using
 * unit quaternions", 1987. The rotation is the eigenvector of the largest eigenvalue of a symmetric
 * 4 x 4 matrix, found by Jacobi's method.
 */
#include "base/context.h"
#include "register/register_private.h"
#include "scene/file_text.h"

#include <math.h>
#include <string.h>

#define LARGEST_FILE ((size_t)16 << 20)

/* ---- reading ---- */

static bool read_pair(const char **at, igi_point_pair *pair)
{
    double numbers[6];
    for (int k = 0; k < 6; k++) {
        *at += strspn(*at, " \t,");
        if (!igi_scan_number(at, &numbers[k]) || !(fabs(numbers[k]) < 1e15)) return false;
    }
    *at += strspn(*at, " \t\r");
    memcpy(pair->from, numbers, sizeof pair->from);
    memcpy(pair->to, numbers + 3, sizeof pair->to);
    return *at[0] == '\n' || *at[0] == '#' || !*at[0];
}

igi_status igi_point_pairs_read(igi_context *ctx, const char *path, igi_point_pair **pairs,
                                size_t *count)
{
    igi_status status = IGI_OK;
    igi_text text = {0};
    igi_point_pair *made = NULL;
    size_t capacity = 0;
    *pairs = NULL;
    *count = 0;
    IGI_TRY(igi_text_load(ctx, path, LARGEST_FILE, &text));
    int line = 1;
    for (const char *at = text.bytes; *at; line++) {
        at += strspn(at, " \t\r");
        if (*at && *at != '\n' && *at != '#') {
            igi_point_pair *grown = igi_grow(ctx, made, &capacity, *count + 1, sizeof *made);
            if (!grown) status = IGI_E_SYSTEM;
            else made = grown;
            if (grown && !read_pair(&at, &made[(*count)++]))
                status = igi_fail(ctx, IGI_E_DATA,
                                  "%s:%d: not six numbers; write X Y Z of the cameras' frame, then "
                                  "X Y Z of the mesh's",
                                  path, line);
            if (status != IGI_OK) break;
        }
        at += strcspn(at, "\n");
        at += *at == '\n';
    }
    igi_free(text.bytes);
    if (status == IGI_OK) *pairs = made;
    else {
        igi_free(made);
        *count = 0;
    }
    return status;
}

void igi_point_pairs_destroy(igi_point_pair *pairs)
{
    igi_free(pairs);
}

/* ---- fitting ---- */

/* Eigenvectors of a symmetric matrix in the columns of v, eigenvalues on its diagonal. */
static void diagonalise(double a[4][4], double v[4][4])
{
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) v[i][j] = i == j;
    for (int sweep = 0; sweep < 40; sweep++)
        for (int p = 0; p < 3; p++)
            for (int q = p + 1; q < 4; q++) {
                if (a[p][q] == 0) continue;
                double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
                double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
                double c = 1 / sqrt(t * t + 1), s = t * c;
                for (int k = 0; k < 4; k++) {
                    double x = a[k][p], y = a[k][q];
                    a[k][p] = c * x - s * y, a[k][q] = s * x + c * y;
                }
                for (int k = 0; k < 4; k++) {
                    double x = a[p][k], y = a[q][k];
                    a[p][k] = c * x - s * y, a[q][k] = s * x + c * y;
                    x = v[k][p], y = v[k][q];
                    v[k][p] = c * x - s * y, v[k][q] = s * x + c * y;
                }
            }
}

static void rotation_of(const double q[4], double r[3][3])
{
    double w = q[0], x = q[1], y = q[2], z = q[3];
    const double m[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                            {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                            {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
    memcpy(r, m, sizeof m);
}

static void apply(const igi_similarity *s, const double from[3], double to[3])
{
    for (int i = 0; i < 3; i++) {
        to[i] = s->offset[i];
        for (int k = 0; k < 3; k++) to[i] += s->scale * s->rotation[i][k] * from[k];
    }
}

/* Horn's matrix of the sums m[i][k] = sum from_i to_k; false when it leaves a turn open. */
static bool find_rotation(double m[3][3], double r[3][3])
{
    double n[4][4] = {
        {m[0][0] + m[1][1] + m[2][2], m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0]},
        {0, m[0][0] - m[1][1] - m[2][2], m[0][1] + m[1][0], m[2][0] + m[0][2]},
        {0, 0, -m[0][0] + m[1][1] - m[2][2], m[1][2] + m[2][1]},
        {0, 0, 0, -m[0][0] - m[1][1] + m[2][2]}};
    double v[4][4], q[4], size = 0;
    int best = 0;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < i; j++) n[i][j] = n[j][i];
    diagonalise(n, v);
    for (int i = 1; i < 4; i++)
        if (n[i][i] > n[best][best]) best = i;
    for (int i = 0; i < 4; i++) {
        size = fmax(size, fabs(n[i][i]));
        q[i] = v[i][best];
    }
    for (int i = 0; i < 4; i++)
        if (i != best && n[best][best] - n[i][i] <= 1e-6 * size) return false;
    rotation_of(q, r);
    return size > 0;
}

igi_status igi_similarity_fit(igi_context *ctx, const igi_point_pair *pairs, size_t count,
                              igi_similarity *similarity, double *rms_m)
{
    double from[3] = {0}, to[3] = {0}, m[3][3] = {{0}}, spread = 0, along = 0, sum = 0;
    igi_similarity *s = similarity;
    *s = (igi_similarity){.scale = 1};
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            from[k] += pairs[i].from[k] / (double)count;
            to[k] += pairs[i].to[k] / (double)count;
        }
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            double a = pairs[i].from[k] - from[k];
            spread += a * a;
            for (int l = 0; l < 3; l++) m[k][l] += a * (pairs[i].to[l] - to[l]);
        }
    if (count < 3 || !(spread > 0) || !find_rotation(m, s->rotation))
        return igi_fail(ctx, IGI_E_NO_ANSWER,
                        "points: three pairs or more are needed, not all on one line");
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) along += s->rotation[i][k] * m[k][i];
    s->scale = along / spread;
    if (!(s->scale > 0))
        return igi_fail(ctx, IGI_E_NO_ANSWER, "points: the one frame mirrors the other");
    for (int i = 0; i < 3; i++) {
        s->offset[i] = to[i];
        for (int k = 0; k < 3; k++) s->offset[i] -= s->scale * s->rotation[i][k] * from[k];
    }
    for (size_t i = 0; i < count; i++) {
        double there[3];
        apply(s, pairs[i].from, there);
        for (int k = 0; k < 3; k++)
            sum += (there[k] - pairs[i].to[k]) * (there[k] - pairs[i].to[k]);
    }
    *rms_m = sqrt(sum / (double)count);
    return IGI_OK;
}
