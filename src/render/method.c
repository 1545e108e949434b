/* SPDX-License-Identifier: Apache-2.0
 *
 * The forward methods on one interface: each is where paths end and how they go on.
 */
#include "render/cache.h"

#include <string.h>

static const struct method {
    const char *name;
    int max_depth;  /* edges; 0: as the options say */
    int cache_edge; /* radiosity is looked up there; 0: none */
    bool mirrors, shoots;
} methods[] = {
    [IGI_RENDER_PATH] = {"path", 0, 0, false, false},
    [IGI_RENDER_DIRECT] = {"direct", 2, 0, false, false},
    [IGI_RENDER_WHITTED] = {"whitted", 6, 0, true, false},
    [IGI_RENDER_RADIOSITY] = {"radiosity", 0, 1, false, false},
    [IGI_RENDER_PROGRESSIVE] = {"progressive", 0, 1, false, true},
};
enum { METHODS = sizeof methods / sizeof methods[0] };

const char *igi_render_method_name(igi_render_method method)
{
    return (size_t)method < METHODS ? methods[method].name : "unknown";
}

bool igi_render_method_from_name(const char *name, igi_render_method *method)
{
    for (size_t i = 0; i < METHODS; i++)
        if (strcmp(name, methods[i].name) == 0) {
            *method = (igi_render_method)i;
            return true;
        }
    return false;
}

igi_status igi_renderer_set_method(igi_context *ctx, igi_renderer *renderer,
                                   igi_render_method method, int *max_depth)
{
    const struct method *m = &methods[method];
    if (m->max_depth > 0 && *max_depth > m->max_depth) *max_depth = m->max_depth;
    renderer->mirrors = m->mirrors;
    if (m->cache_edge == 0) return IGI_OK;
    igi_cache_options fine = {
        .rays = 256, .light_points = 4, .patch_share = 0.02f, .shoot = m->shoots};
    IGI_TRY(igi_cache_create(ctx, renderer, &fine, &renderer->cache));
    renderer->cache_edge = m->cache_edge;
    return IGI_OK;
}
