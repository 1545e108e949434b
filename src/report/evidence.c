/* SPDX-License-Identifier: Apache-2.0
 *
 * evidence.json: what was tried on each region and what it was given.
 */
#include "base/file.h"

#include <igi/report.h>

#include <jansson.h>
#include <math.h>

static json_t *number(double x)
{
    return isfinite(x) ? json_real(x) : json_null();
}

static json_t *tried_json(const igi_model_evidence *e)
{
    json_t *o = json_object();
    int bad = json_object_set_new(o, "look", json_string(e->look));
    bad |= json_object_set_new(o, "model", json_string(igi_model_name(e->model)));
    bad |= json_object_set_new(o, "gain", number(e->gain));
    bad |= json_object_set_new(o, "residuals", number(e->residuals));
    bad |= json_object_set_new(o, "noise", number(e->noise));
    bad |= json_object_set_new(o, "plain_noise", number(e->plain_noise));
    bad |= json_object_set_new(o, "specular", number(e->specular));
    bad |= json_object_set_new(o, "specular_std", number(e->specular_std));
    bad |= json_object_set_new(o, "alpha", number(e->alpha));
    bad |= json_object_set_new(o, "at_bound", json_boolean(e->at_bound));
    bad |= json_object_set_new(o, "coloured", json_boolean(e->coloured));
    bad |= json_object_set_new(o, "colour_gain", number(e->colour_gain));
    if (!bad) return o;
    json_decref(o);
    return NULL;
}

/* The numbers that a region was given: an albedo of each band, or of each texel, and a lobe's two. */
static json_t *region_json(const igi_material *m, const igi_region_evidence *e, int bands)
{
    json_t *o = json_object(), *tried = json_array();
    size_t texels = m->textured && m->map ? (size_t)m->map->width * (size_t)m->map->height : 0;
    int lobe = m->model == IGI_LAMBERT ? 0 : m->specular_is_rgb ? bands + 1 : 2;
    int bad = json_object_set_new(o, "model", json_string(igi_model_name(m->model)));
    bad |= json_object_set_new(o, "parameters", json_integer(bands + lobe));
    bad |= json_object_set_new(o, "texels", json_integer((json_int_t)texels));
    bad |= json_object_set_new(o, "gathered_rays", json_integer((json_int_t)e->gathered_rays));
    bad |= json_object_set_new(o, "lobe_rays", json_integer((json_int_t)e->lobe_rays));
    const igi_texture_evidence *t = &e->texture;
    bad |= json_object_set_new(o, "texture",
                               json_pack("{s:b, s:b, s:o, s:o, s:o}", "given", t->given, "found",
                                         m->textured, "amplitude", number(t->amplitude), "least",
                                         number(t->least), "agreement", number(t->agreement)));
    for (size_t i = 0; i < e->count; i++)
        bad |= json_array_append_new(tried, tried_json(&e->tried[i]));
    bad |= json_object_set_new(o, "tried", tried);
    if (!bad) return o;
    json_decref(o);
    return NULL;
}

static json_t *registered_json(const igi_registered *r)
{
    json_t *o = json_object(), *images = json_object();
    int bad = json_object_set_new(o, "before_px", number(r->before_px));
    bad |= json_object_set_new(o, "after_px", number(r->after_px));
    if (r->lens) {
        bad |= json_object_set_new(o, "principal_point_px",
                                   json_pack("[ff]", r->shared.shift_px[0], r->shared.shift_px[1]));
        bad |= json_object_set_new(o, "focal_length", number(r->shared.magnification));
    }
    if (r->world) bad |= json_object_set_new(o, "scale", number(r->together.scale));
    for (size_t i = 0; i < r->frame_count; i++) {
        const igi_registered_frame *f = &r->frames[i];
        json_t *image = json_object();
        bad |= json_object_set_new(image, "edges", json_integer((json_int_t)f->edges));
        bad |= json_object_set_new(image, "before_px", number(f->before_px));
        bad |= json_object_set_new(image, "after_px", number(f->after_px));
        bad |= json_object_set_new(image, "moved_px", number(f->moved_px));
        bad |= json_object_set_new(image, "sigma_px", number(f->sigma_px));
        bad |= json_object_set_new(image, "moved", json_boolean(f->moved));
        bad |= json_object_set_new(image, "unsettled", json_boolean(f->unsettled));
        bad |= json_object_set_new(images, f->image, image);
    }
    bad |= json_object_set_new(o, "images", images);
    if (!bad) return o;
    json_decref(o);
    return NULL;
}

igi_status igi_evidence_save(igi_context *ctx, const igi_recovery *recovery, const char *folder)
{
    igi_status status = IGI_OK;
    const igi_materials *m = recovery->materials;
    json_t *root = json_object(), *regions = json_object();
    char *path = NULL;
    int bad = json_object_set_new(root, "igi", json_integer(1));
    for (size_t i = 0; i < m->count; i++)
        if (!m->materials[i].emitter)
            bad |= json_object_set_new(
                regions, m->materials[i].region,
                region_json(&m->materials[i], &recovery->evidence[i], m->bands));
    bad |= json_object_set_new(root, "regions", regions);
    if (recovery->registered)
        bad |= json_object_set_new(root, "registered", registered_json(recovery->registered));
    if (bad) IGI_TRY_GOTO(igi_fail(ctx, IGI_E_SYSTEM, "evidence.json: no memory, or no UTF-8"));
    IGI_TRY_GOTO(igi_strprintf(ctx, &path, "%s/evidence.json", folder));
    status = igi_file_save_json(ctx, path, root, 6);
cleanup:
    json_decref(root);
    igi_free(path);
    return status;
}
