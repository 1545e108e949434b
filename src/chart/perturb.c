/* SPDX-License-Identifier: Apache-2.0
 *
 * What the files of perturbations share.
 */
#include "chart/sweep.h"

#include <string.h>

igi_rng chart_stream(const chart_subject *subject, const char *what)
{
    uint64_t key = 0;
    for (; *what; what++) key = igi_hash64(key ^ (unsigned char)*what);
    return igi_rng_make(subject->seed, key);
}

/* Box and Muller 1958. */
double chart_normal(igi_rng *rng)
{
    double u = 1 - (double)igi_rng_float(rng), v = (double)igi_rng_float(rng);
    return sqrt(-2 * log(u)) * cos(2 * IGI_PI * v);
}

size_t chart_region(const igi_scene *scene, const char *name)
{
    size_t i = 0;
    while (i < scene->region_count && strcmp(scene->regions[i].name, name) != 0) i++;
    return i;
}

double chart_photo_mean(const chart_subject *subject)
{
    double sum = 0, count = 0;
    size_t bands = (size_t)subject->scene->bands;
    for (size_t f = 0; f < subject->scene->frame_count; f++) {
        const igi_image *photo = subject->photos[f];
        size_t pixels = (size_t)photo->width * (size_t)photo->height;
        for (size_t i = 0; i < pixels; i++)
            for (size_t b = 0; b < bands; b++) sum += (double)photo->samples[i * (bands + 1) + b];
        count += (double)(pixels * bands);
    }
    return count > 0 ? sum / count : 0;
}

void chart_unjudge(igi_materials *truth, const char *region)
{
    for (size_t i = 0; i < truth->count; i++)
        if (strcmp(truth->materials[i].region, region) == 0) truth->materials[i].observed = 0;
}
