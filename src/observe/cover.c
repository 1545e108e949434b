/* SPDX-License-Identifier: Apache-2.0 */
#include "observe/cover.h"

#include "observe/visible.h"

#define SIDE 8      /* rays along the pixel's side */
#define MARGIN 0.25 /* pixels that cameras may be off */

/* Do all of a lattice of rays over a square about the pixel's middle meet what the middle shows? The
 * lattice is walked by long strides: what is mixed is found by the first few. */
static bool is_filled(const igi_scene *scene, const igi_tracer *tracer, const igi_camera *camera,
                      const double middle[2], double width, const igi_hit *shown, size_t *rays)
{
    igi_vec centre = igi_camera_centre(camera);
    for (int n = 0; n < SIDE * SIDE; n++) {
        int k = n * 27 % (SIDE * SIDE); /* no common factor: each once */
        double x = middle[0] + width * ((k % SIDE) / (SIDE - 1.0) - 0.5);
        double y = middle[1] + width * ((k / SIDE) / (SIDE - 1.0) - 0.5);
        igi_hit hit = igi_trace(tracer, centre, igi_camera_direction(camera, x, y));
        ++*rays;
        if (igi_visible_is_edge(scene, tracer, shown, &hit, (float)(1 / camera->fl_x)))
            return false;
    }
    return true;
}

igi_cover igi_cover_of(const igi_scene *scene, const igi_tracer *tracer, const igi_camera *camera,
                       uint32_t pixel, size_t *rays)
{
    uint32_t width = (uint32_t)camera->width;
    double middle[2] = {pixel % width + 0.5, pixel / width + 0.5};
    igi_vec ahead = igi_camera_direction(camera, middle[0], middle[1]);
    igi_hit shown = igi_trace(tracer, igi_camera_centre(camera), ahead);
    ++*rays;
    if (!is_filled(scene, tracer, camera, middle, 1, &shown, rays)) return IGI_COVER_PART;
    return is_filled(scene, tracer, camera, middle, 1 + 2 * MARGIN, &shown, rays) ? IGI_COVER_WIDE
                                                                                  : IGI_COVER_WHOLE;
}
