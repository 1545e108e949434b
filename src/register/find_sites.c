/* SPDX-License-Identifier: Apache-2.0
 *
 * One photograph, and the mesh's edges in it.
 */
#include "register/register_private.h"

igi_status register_load(igi_context *ctx, const register_job *j, size_t frame, igi_image **photo)
{
    char *warning;
    IGI_TRY(igi_photographs_load(ctx, j->photographs, frame, photo, &warning));
    igi_free(warning);
    return IGI_OK;
}

igi_status register_find_sites(igi_context *ctx, const register_job *j, const igi_camera *camera,
                               const igi_image *photo, double reach, igi_edge_sites *sites)
{
    igi_status status = IGI_OK;
    igi_visible visible = {0};
    const igi_edge_search search = {j->scene, j->tracer, camera, photo, &visible, reach, SIZE_MAX};
    IGI_TRY_GOTO(igi_visible_create(ctx, j->scene, j->tracer, camera, &visible));
    IGI_TRY_GOTO(igi_edge_sites_find(ctx, &search, sites));
cleanup:
    igi_visible_clear(&visible);
    return status;
}
