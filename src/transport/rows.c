/* SPDX-License-Identifier: Apache-2.0
 *
 * What a gathered row of the transport says, given the radiance of all sides.
 */
#include "transport/gather.h"

void igi_rows_destroy(igi_rows *rows)
{
    if (!rows) return;
    igi_free(rows->side);
    igi_free(rows->row_of);
    igi_free(rows->begin);
    igi_free(rows->hits);
    igi_free(rows->met);
    igi_free(rows->direct);
    igi_free(rows->open);
    igi_free(rows->visible_var);
    igi_free(rows->point);
    igi_free(rows);
}

void igi_row_indirect(const igi_rows *rows, size_t row, const float *radiance, int bands,
                      float *irradiance)
{
    const uint32_t *hits = rows->hits + rows->begin[row];
    size_t rays = rows->begin[row + 1] - rows->begin[row];
    float sum[IGI_MAX_BANDS] = {0};
    if (bands == 3) { /* sums that stay in registers take half the time */
        float r = 0, g = 0, blue = 0;
        for (size_t k = 0; k < rays; k++) {
            if (hits[k] == IGI_NO_SIDE) continue;
            const float *met = radiance + 3 * (size_t)hits[k];
            r += met[0];
            g += met[1];
            blue += met[2];
        }
        sum[0] = r;
        sum[1] = g;
        sum[2] = blue;
    }
    for (size_t k = 0; bands != 3 && k < rays; k++) {
        if (hits[k] == IGI_NO_SIDE) continue;
        const float *met = radiance + (size_t)hits[k] * (size_t)bands;
        for (int b = 0; b < bands; b++) sum[b] += met[b];
    }
    float scale = rays > 0 ? IGI_PIF / (float)rays : 0;
    for (int b = 0; b < bands; b++) irradiance[b] = scale * sum[b];
}

double igi_row_variance(const igi_rows *rows, size_t row, const float *radiance, int bands,
                        int band)
{
    size_t begin = rows->begin[row], end = rows->begin[row + 1];
    double sum = 0, squares = 0, n = (double)(end - begin);
    for (size_t k = begin; k < end; k++) {
        uint32_t side = rows->hits[k];
        double x = side == IGI_NO_SIDE ? 0 : (double)radiance[side * (size_t)bands + (size_t)band];
        sum += x;
        squares += x * x;
    }
    return IGI_PI * IGI_PI * fmax(0, squares / n - sum * sum / (n * n)) / n;
}

void igi_row_direct(const igi_rows *rows, size_t row, const igi_light *lights, int bands,
                    float *irradiance)
{
    for (int b = 0; b < bands; b++) {
        double sum = 0;
        for (size_t l = 0; l < rows->lights; l++)
            sum += (double)rows->direct[row * rows->lights + l] * lights[l].value[b];
        irradiance[b] = (float)sum;
    }
}
