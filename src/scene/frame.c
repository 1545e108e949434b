/* SPDX-License-Identifier: Apache-2.0 */
#include "scene/frame.h"

#include <math.h>
#include <string.h>

bool igi_frame_orthonormalize(igi_camera *camera)
{
    double(*m)[4] = camera->camera_to_world;
    double column[3][3], length[3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            if (!(fabs(m[i][j]) < 1e15)) return false;
    for (int j = 0; j < 3; j++) {
        length[j] = sqrt(m[0][j] * m[0][j] + m[1][j] * m[1][j] + m[2][j] * m[2][j]);
        if (!(length[j] > 1e-9)) return false;
        for (int i = 0; i < 3; i++) column[j][i] = m[i][j] / length[j];
    }
    const double tolerance = 2e-3;
    for (int j = 0; j < 3; j++) {
        const double *a = column[j], *b = column[(j + 1) % 3];
        if (fabs(length[j] / length[0] - 1) > tolerance) return false;
        if (fabs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) > tolerance) return false;
    }
    double *x = column[0], *y = column[1], *z = column[2];
    double dot = x[0] * y[0] + x[1] * y[1] + x[2] * y[2], norm = 0;
    for (int i = 0; i < 3; i++) y[i] -= dot * x[i];
    for (int i = 0; i < 3; i++) norm += y[i] * y[i];
    for (int i = 0; i < 3; i++) y[i] /= sqrt(norm);
    const double right_handed[3] = {x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2],
                                    x[0] * y[1] - x[1] * y[0]};
    if (right_handed[0] * z[0] + right_handed[1] * z[1] + right_handed[2] * z[2] < 0)
        return false; /* it mirrors */
    memcpy(z, right_handed, sizeof right_handed);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) m[i][j] = column[j][i];
    return true;
}

const char *igi_camera_fault(const igi_camera *c)
{
    const double all[] = {c->fl_x, c->fl_y, c->cx, c->cy, c->k1, c->k2, c->k3, c->p1, c->p2};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
        if (!(fabs(all[i]) < 1e12)) return "an intrinsic number is not finite";
    if (c->width < 1 || c->height < 1 || c->width > 1 << 20 || c->height > 1 << 20)
        return "the image's width and height must be 1 to 1048576 pixels";
    if (!(c->fl_x > 0 && c->fl_y > 0)) return "the focal length must be above 0 pixels";
    return NULL;
}

igi_status igi_image_path(igi_context *ctx, const char *folder, const char *name, char **path)
{
    char *other = NULL;
    IGI_TRY(igi_path_join(ctx, folder, name, path));
    if (igi_file_exists(*path)) return IGI_OK;
    const char *slash = strrchr(*path, '/');
    const char *dot = strrchr(slash ? slash : *path, '.');
    const int lengths[2] = {(int)strlen(*path), dot ? (int)(dot - *path) : 0};
    for (int i = 0; i < 2; i++) {
        if (lengths[i] == 0) continue;
        igi_status status = igi_strprintf(ctx, &other, "%.*s.exr", lengths[i], *path);
        if (status != IGI_OK) {
            igi_free(*path);
            *path = NULL;
            return status;
        }
        if (igi_file_exists(other)) {
            igi_free(*path);
            *path = other;
            return IGI_OK;
        }
        igi_free(other);
    }
    return IGI_OK;
}
