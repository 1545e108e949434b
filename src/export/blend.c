/* SPDX-License-Identifier: Apache-2.0
 *
 * Lobes as blends. Renderers blend two materials by a weight, so that igi's sum
 * rho_d/pi + lobe becomes (1-w) [rho_d/(1-w)/pi] + w [lobe/w], exactly, for any weight w that
 * leaves both brackets reflectances of at most one.
 *
 *   ggx    the same D; F by an index of refraction of the same F0 (Fresnel's own curve, not
 *          Schlick's); the renderer's masking
 *   ward   Beckmann of the same alpha, constant F. Ward's exp(-tan^2/alpha^2)/(4 pi alpha^2
 *          sqrt(cos_i cos_o)) is Beckmann's D/(4 cos_i cos_o) times cos^4 delta sqrt(cos_i cos_o) /
 *          masking: alike at steep angles, darker than Beckmann's at grazing ones
 *   phong  Beckmann of the same peak and width: the angle to the mirror direction is twice that of
 *          the half vector, so its alpha is that of the exponent 4n
 */
#include "export/export_private.h"

#include <math.h>

#define LARGEST_SHARE 0.95
#define SMALLEST_SHARE 0.01

bool igi_export_is_textured(const igi_scene *scene, const igi_material *m, size_t region)
{
    return m->map && m->textured && !m->emitter && scene->mesh.uvs &&
           scene->regions[region].has_uvs;
}

void igi_export_rgb(const double *value, int bands, double rgb[3])
{
    for (int k = 0; k < 3; k++) rgb[k] = value[k < bands ? k : bands - 1];
}

double igi_export_index(double f0)
{
    double root = sqrt(fmin(fmax(f0, 0), 0.99));
    return (1 + root) / (1 - root);
}

/* The brightest colour that the diffuse part has anywhere. */
static double largest_albedo(const igi_exporter *e, size_t region)
{
    const igi_material *m = &e->materials->materials[region];
    int bands = e->materials->bands;
    double largest = 0;
    if (!igi_export_is_textured(e->scene, m, region)) {
        for (int b = 0; b < bands; b++) largest = fmax(largest, m->albedo[b]);
        return largest;
    }
    size_t texels = (size_t)m->map->width * (size_t)m->map->height;
    for (size_t i = 0; i < texels; i++)
        for (int b = 0; b < bands; b++)
            largest = fmax(largest,
                           (double)m->map->samples[i * (size_t)m->map->channels + (size_t)b]);
    return largest;
}

igi_blend igi_export_blend(const igi_exporter *e, size_t region)
{
    const igi_material *m = &e->materials->materials[region];
    igi_blend blend = {.diffuse = 1, .is_ggx = m->model == IGI_GGX};
    blend.has_fresnel = blend.is_ggx;
    double flat[IGI_MAX_BANDS], specular = 0;
    for (int b = 0; b < IGI_MAX_BANDS; b++) flat[b] = m->specular;
    igi_export_rgb(m->specular_is_rgb ? m->specular_rgb : flat, e->materials->bands,
                   blend.specular);
    for (int k = 0; k < 3; k++) specular = fmax(specular, blend.specular[k]);
    if (m->emitter || m->model == IGI_LAMBERT || !(specular > 0)) return blend;
    blend.alpha = m->alpha;
    if (m->model == IGI_PHONG) blend.alpha /= sqrt(4 - 3 * m->alpha * m->alpha);
    /* As large as the diffuse part allows, where F has to reach 1; else as the lobe needs. */
    double most = fmin(fmax(1 - largest_albedo(e, region), SMALLEST_SHARE), LARGEST_SHARE);
    double need = fmax(specular, SMALLEST_SHARE);
    blend.share = blend.has_fresnel ? most : fmin(need, LARGEST_SHARE);
    blend.diffuse = 1 / (1 - blend.share);
    return blend;
}
