/* SPDX-License-Identifier: Apache-2.0
 *
 * Reading the spec: names, materials, lights; shapes and views have their own files.
 */
#include "synth/synth.h"

#include <math.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static igi_status read_texture(igi_context *ctx, const igi_json *at, int bands, texture *t)
{
    static const char *const known[] = {"kind", "colours", "cells", "size", "seed"};
    static const char *const kinds[] = {"checker", "stripes", "noise"};
    const char *kind;
    int seed = 1;
    IGI_TRY(igi_json_object(ctx, at));
    IGI_TRY(igi_json_check_keys(ctx, at, known, COUNT(known)));
    igi_json kind_at = igi_json_member(at, "kind"), colours = igi_json_member(at, "colours");
    IGI_TRY(igi_json_string(ctx, &kind_at, &kind));
    for (size_t i = 0; i < COUNT(kinds); i++)
        if (strcmp(kind, kinds[i]) == 0) t->kind = (texture_kind)(i + 1);
    if (t->kind == TEXTURE_NONE)
        return igi_json_fail(ctx, &kind_at,
                             "no texture is \"%s\"; there are checker, stripes and noise", kind);
    size_t count;
    IGI_TRY(igi_json_array(ctx, &colours, &count));
    if (count != 2) return igi_json_fail(ctx, &colours, "has %zu colours; give two", count);
    for (size_t i = 0; i < 2; i++) {
        igi_json colour = igi_json_element(&colours, i);
        IGI_TRY(read_bands(ctx, &colour, bands, t->colours[i]));
    }
    t->cells = 8;
    t->size = 256;
    IGI_TRY(optional_int(ctx, at, "cells", 1, 4096, &t->cells));
    IGI_TRY(optional_int(ctx, at, "size", 2, 8192, &t->size));
    IGI_TRY(optional_int(ctx, at, "seed", 0, 1 << 30, &seed));
    t->seed = (uint64_t)seed;
    return IGI_OK;
}

static igi_status read_lobe(igi_context *ctx, const igi_json *at, int bands, igi_material *m)
{
    igi_json model = igi_json_member(at, "model"), specular = igi_json_member(at, "specular");
    const char *name = "lambert";
    if (model.value) IGI_TRY(igi_json_string(ctx, &model, &name));
    if (!igi_model_from_name(name, &m->model))
        return igi_json_fail(ctx, &model,
                             "no model is \"%s\"; there are lambert, ward, ggx and phong", name);
    if (m->model == IGI_LAMBERT) return IGI_OK;
    IGI_TRY(read_bands(ctx, &specular, bands, m->specular_rgb));
    m->specular_is_rgb = json_is_array(specular.value);
    for (int b = 0; b < bands; b++) m->specular += m->specular_rgb[b] / bands;
    m->alpha = -1;
    IGI_TRY(optional_number(ctx, at, "alpha", 1e-3, 1, &m->alpha));
    if (m->alpha < 0)
        return igi_json_fail(ctx, at, "a glossy material needs \"alpha\", 0.001 to 1");
    return IGI_OK;
}

static igi_status read_material(igi_context *ctx, spec *s, const igi_json *at, const char *name)
{
    static const char *const known[] = {"albedo", "model",   "specular",
                                        "alpha",  "texture", "emitter"};
    size_t i = s->materials->count++;
    igi_material *m = &s->materials->materials[i];
    igi_json albedo = igi_json_member(at, "albedo"), map = igi_json_member(at, "texture");
    igi_json emitter = igi_json_member(at, "emitter");
    IGI_TRY(igi_strdup(ctx, name, &m->region));
    IGI_TRY(igi_json_object(ctx, at));
    IGI_TRY(igi_json_check_keys(ctx, at, known, COUNT(known)));
    m->determined = true;
    m->observed = 1;
    if (emitter.value) IGI_TRY(igi_json_bool(ctx, &emitter, &m->emitter));
    if (m->emitter) return IGI_OK;
    IGI_TRY(read_lobe(ctx, at, s->materials->bands, m));
    if (!map.value) return read_bands(ctx, &albedo, s->materials->bands, m->albedo);
    if (albedo.value)
        return igi_json_fail(ctx, &albedo, "and \"texture\" exclude each other; keep one");
    m->textured = true;
    return read_texture(ctx, &map, s->materials->bands, &s->textures[i]);
}

static igi_status read_materials(igi_context *ctx, spec *s, int bands)
{
    igi_json at = igi_json_member(&s->root, "materials");
    IGI_TRY(igi_json_object(ctx, &at));
    size_t count = json_object_size(at.value);
    if (count == 0) return igi_json_fail(ctx, &at, "is empty; name a material at least");
    IGI_TRY(IGI_ALLOC(ctx, 1, &s->materials));
    s->materials->bands = bands;
    IGI_TRY(igi_strdup(ctx, s->name, &s->materials->scene));
    IGI_TRY(IGI_ALLOC(ctx, count, &s->materials->materials));
    IGI_TRY(IGI_ALLOC(ctx, count, &s->textures));
    const char *name;
    json_t *unused;
    json_object_foreach (at.value, name, unused) {
        igi_json material = igi_json_member(&at, name);
        IGI_TRY(read_material(ctx, s, &material, name));
    }
    return IGI_OK;
}

static igi_status read_shapes(igi_context *ctx, spec *s)
{
    igi_json at = igi_json_member(&s->root, "shapes");
    size_t count;
    IGI_TRY(igi_json_array(ctx, &at, &count));
    for (size_t i = 0; i < count; i++) {
        igi_json shape = igi_json_element(&at, i);
        IGI_TRY(shape_read(ctx, s, &shape));
    }
    if (s->face_count == 0) return igi_json_fail(ctx, &at, "is empty; give a room at least");
    return IGI_OK;
}

static igi_status read_relit(igi_context *ctx, spec *s)
{
    static const char *const known[] = {"lights", "views"};
    s->relit_array = igi_json_member(&s->root, "relit");
    if (!s->relit_array.value) return IGI_OK;
    size_t count;
    IGI_TRY(igi_json_array(ctx, &s->relit_array, &count));
    IGI_TRY(IGI_ALLOC(ctx, count, &s->relit));
    IGI_TRY(IGI_ALLOC(ctx, count, &s->relit_elements));
    for (size_t i = 0; i < count; i++) {
        igi_json *element = &s->relit_elements[i];
        *element = igi_json_element(&s->relit_array, i);
        IGI_TRY(igi_json_object(ctx, element));
        IGI_TRY(igi_json_check_keys(ctx, element, known, COUNT(known)));
        relit_set *set = &s->relit[s->relit_count++];
        set->lights = igi_json_member(element, "lights");
        set->views = s->views;
        set->views.look = NULL;
        set->views.look_count = 0;
        set->views.seed = 1000 + i;
        igi_json views = igi_json_member(element, "views");
        IGI_TRY(views_read(ctx, &views, &set->views));
    }
    return IGI_OK;
}

static igi_status read_views(igi_context *ctx, spec *s)
{
    igi_json views = igi_json_member(&s->root, "views"),
             heldout = igi_json_member(&s->root, "heldout");
    s->views = (view_set){
        .width = 320, .height = 240, .count = 24, .samples = 128, .fov_deg = 75, .seed = 1};
    IGI_TRY(views_read(ctx, &views, &s->views));
    s->has_heldout = heldout.value != NULL;
    if (!s->has_heldout) return IGI_OK;
    s->heldout = s->views;
    s->heldout.look = NULL;
    s->heldout.look_count = 0;
    s->heldout.seed = 999;
    return views_read(ctx, &heldout, &s->heldout);
}

igi_status spec_load(igi_context *ctx, const char *path, spec *s)
{
    static const char *const known[] = {"igi_synth", "name",    "about",  "bands",
                                        "materials", "shapes",  "lights", "random",
                                        "views",     "heldout", "relit",  "highlights"};
    int bands = 3;
    double version;
    *s = (spec){.name = ""};
    IGI_TRY(igi_json_load(ctx, path, &s->file));
    s->root = igi_json_root(&s->file);
    IGI_TRY(igi_json_object(ctx, &s->root));
    igi_json number = igi_json_member(&s->root, "igi_synth"),
             name = igi_json_member(&s->root, "name");
    if (!number.value)
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: no spec of a room (it lacks \"igi_synth\": 1); give one "
                        "like those in datasets-synthetic",
                        path);
    IGI_TRY(igi_json_check_keys(ctx, &s->root, known, COUNT(known)));
    IGI_TRY(igi_json_number(ctx, &number, &version));
    if (version != 1)
        return igi_json_fail(ctx, &number, "is %g; this program reads version 1", version);
    IGI_TRY(igi_json_string(ctx, &name, &s->name));
    IGI_TRY(random_expand(ctx, &s->root));
    IGI_TRY(optional_int(ctx, &s->root, "bands", 1, IGI_MAX_BANDS, &bands));
    IGI_TRY(read_materials(ctx, s, bands));
    IGI_TRY(read_shapes(ctx, s));
    s->lights = igi_json_member(&s->root, "lights");
    igi_json highlights = igi_json_member(&s->root, "highlights");
    s->highlights = true;
    if (highlights.value) IGI_TRY(igi_json_bool(ctx, &highlights, &s->highlights));
    IGI_TRY(read_views(ctx, s));
    return read_relit(ctx, s);
}

void spec_clear(spec *s)
{
    igi_materials_destroy(s->materials);
    igi_free(s->textures);
    igi_free(s->views.look);
    igi_free(s->heldout.look);
    for (size_t i = 0; i < s->relit_count; i++) igi_free(s->relit[i].views.look);
    igi_free(s->relit);
    igi_free(s->relit_elements);
    igi_free(s->faces);
    if (s->file.root) igi_json_unload(&s->file);
}
