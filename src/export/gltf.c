/* SPDX-License-Identifier: Apache-2.0
 *
 * scene.glb: the mesh with the recovered materials as binary glTF 2.0.
 *
 * glTF's core material is a metal-rough GGX. A dielectric there has F0 = .04, which
 * KHR_materials_specular scales: specularColorFactor = rho_s/.04 makes F0 = rho_s, and
 * specularFactor = 0 a lambert surface. Roughness is sqrt(alpha). glTF is Y-up with the origin of
 * texture coordinates at the top left: a node turns our Z up, and v becomes 1 - v.
 */
#include "export/gltf_private.h"
#include "base/file.h"
#include "image/srgb.h"
#include "scene/atlas.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* By how much glTF's base colour is above the albedo. Its dielectric leaves the diffuse part what the
 * lobe does not reflect, base (1 - E), where ours is a sum; and its lobe grows toward grazing angles,
 * which of ours ggx alone does. E, the mean over directions of a GGX lobe with Schlick's F, is F0 (g -
 * b) + b, with g and b fitted to quadratures for alpha up to .5 within .002. So that as much light is
 * reflected: base (1 - E) + E = albedo + what our lobe reflects, E of ggx, about F0 of the others. */
static double base_scale(const igi_material *m, int bands)
{
    if (m->emitter || m->model == IGI_LAMBERT) return 1;
    double a = m->alpha, b = 1 / (21 + a * (70 + 250 * a)), g = 1 - a * a / (.27 + 1.08 * a);
    double e = fmin(m->specular * (g - b) + b, .9), albedo = 0;
    for (int k = 0; k < bands; k++) albedo += m->albedo[k] / bands;
    double missing = m->model == IGI_GGX ? 0 : fmin(e - m->specular, albedo);
    return albedo > 0 ? (albedo - missing) / albedo / (1 - e) : 1;
}

static igi_status add_texture(igi_glb *g, const igi_image *map, double scale, int *texture)
{
    igi_status status = IGI_OK;
    size_t size, offset;
    int view;
    uint8_t *png = NULL;
    IGI_TRY_GOTO(igi_srgb_png(g->ctx, map, g->materials->bands, (float)scale, &png, &size));
    IGI_TRY_GOTO(igi_glb_add_view(g, size, 0, &offset, &view));
    memcpy(g->bytes + offset, png, size);
    *texture = (int)json_array_size(g->textures);
    int bad = json_array_append_new(
        g->images, json_pack("{s:i, s:s}", "bufferView", view, "mimeType", "image/png"));
    bad |= json_array_append_new(g->textures, json_pack("{s:i}", "source", *texture));
    if (bad) IGI_TRY_GOTO(igi_glb_full(g));
cleanup:
    igi_image_free_bytes(png);
    return status;
}

static json_t *colour(const double *x, int bands, double scale)
{
    return json_pack("[f,f,f]", scale * x[0], scale * x[bands > 1 ? 1 : 0],
                     scale * x[bands > 2 ? 2 : bands - 1]);
}

/* Radiance becomes a factor of at most one and its strength. */
static int put_emission(const igi_glb *g, size_t region, json_t *o, json_t *extensions)
{
    int bands = g->materials->bands, bad = 0;
    for (size_t i = 0; i < g->materials->light_count; i++) {
        const igi_light *l = &g->materials->lights[i];
        if (l->type != IGI_LIGHT_AREA || l->region != (int)region) continue;
        double most = 0;
        for (int b = 0; b < bands; b++) most = fmax(most, l->value[b]);
        if (!(most > 0)) continue;
        bad |= json_object_set_new(o, "emissiveFactor", colour(l->value, bands, 1 / most));
        bad |= json_object_set_new(extensions, "KHR_materials_emissive_strength",
                                   json_pack("{s:f}", "emissiveStrength", most));
    }
    return bad;
}

static igi_status add_material(igi_glb *g, size_t region, bool textured)
{
    const igi_material *m = &g->materials->materials[region];
    int bands = g->materials->bands, texture = 0;
    bool glossy = m->model != IGI_LAMBERT;
    double black[IGI_MAX_BANDS] = {0}, flat[IGI_MAX_BANDS], scale = base_scale(m, bands);
    for (int b = 0; b < IGI_MAX_BANDS; b++) flat[b] = m->specular;
    const double *base = m->emitter ? black : m->albedo;
    double bright[IGI_MAX_BANDS];
    for (int b = 0; b < bands; b++) bright[b] = fmin(1, scale * base[b]);
    const double *lobe = m->specular_is_rgb ? m->specular_rgb : flat;
    json_t *factor = textured ? json_pack("[f,f,f]", 1.0, 1.0, 1.0) : colour(bright, bands, 1);
    json_array_append_new(factor, json_real(1));
    json_t *pbr = json_pack("{s:o, s:f, s:f}", "baseColorFactor", factor, "metallicFactor", 0.0,
                            "roughnessFactor", glossy ? sqrt(m->alpha) : 1.0);
    if (textured) {
        igi_status status = add_texture(g, m->map, scale, &texture);
        json_object_set_new(pbr, "baseColorTexture", json_pack("{s:i}", "index", texture));
        if (status != IGI_OK) json_decref(pbr);
        IGI_TRY(status);
    }
    json_t *specular = glossy ? json_pack("{s:o}", "specularColorFactor", colour(lobe, bands, 25))
                              : json_pack("{s:f}", "specularFactor", 0.0);
    json_t *extensions = json_pack("{s:o}", "KHR_materials_specular", specular);
    json_t *o = json_pack("{s:s, s:b, s:o}", "name", m->region, "doubleSided", !m->emitter,
                          "pbrMetallicRoughness", pbr);
    int bad = m->emitter ? put_emission(g, region, o, extensions) : 0;
    bad |= json_object_set_new(o, "extensions", extensions);
    if (glossy)
        bad |= json_object_set_new(
            o, "extras",
            json_pack("{s:s, s:o, s:f, s:f}", "model", igi_model_name(m->model), "albedo",
                      colour(base, bands, 1), "specular", m->specular, "alpha", m->alpha));
    bad |= json_array_append_new(g->material_list, o);
    return bad ? igi_glb_full(g) : IGI_OK;
}

static int add_child(igi_glb *g, json_t *node)
{
    int bad = json_array_append_new(g->children,
                                    json_integer((json_int_t)json_array_size(g->nodes)));
    return bad | json_array_append_new(g->nodes, node);
}

static igi_status add_region(igi_glb *g, size_t region)
{
    const igi_material *m = &g->materials->materials[region];
    bool textured = igi_export_is_textured(g->scene, m, region);
    IGI_TRY(add_material(g, region, textured));
    json_t *primitive = NULL;
    IGI_TRY(igi_glb_add_primitive(g, region, textured, &primitive));
    if (!primitive) return IGI_OK;
    int bad = json_object_set_new(primitive, "material",
                                  json_integer((json_int_t)json_array_size(g->material_list) - 1));
    bad |= add_child(
        g, json_pack("{s:s, s:i}", "name", m->region, "mesh", (int)json_array_size(g->meshes)));
    bad |= json_array_append_new(
        g->meshes, json_pack("{s:s, s:[o]}", "name", m->region, "primitives", primitive));
    return bad ? igi_glb_full(g) : IGI_OK;
}

/* The rotation that turns -Z to `d`: half way between the two, as a quaternion. */
static json_t *rotation_to(const double d[3])
{
    double q[4] = {d[1], -d[0], 0, 1 - d[2]}; /* cross(-Z, d), 1 + dot(-Z, d) */
    double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[3] * q[3]);
    if (length < 1e-9) return json_pack("[f,f,f,f]", 1.0, 0.0, 0.0, 0.0);
    return json_pack("[f,f,f,f]", q[0] / length, q[1] / length, 0.0, q[3] / length);
}

/* Point, spot and directional; glTF knows no others. */
static igi_status add_light(igi_glb *g, const igi_light *l)
{
    static const double degree = 3.14159265358979323846 / 180;
    bool spot = l->type == IGI_LIGHT_SPOT, directional = l->type == IGI_LIGHT_DIRECTIONAL;
    double most = 0;
    int bands = g->materials->bands;
    for (int b = 0; b < bands; b++) most = fmax(most, l->value[b]);
    if (!(spot || directional || l->type == IGI_LIGHT_POINT) || !(most > 0)) return IGI_OK;
    json_t *o = json_pack("{s:s, s:o, s:f}", "type", igi_light_type_name(l->type), "color",
                          colour(l->value, bands, 1 / most), "intensity", most);
    if (spot)
        json_object_set_new(o, "spot",
                            json_pack("{s:f, s:f}", "innerConeAngle", l->beam_deg * degree,
                                      "outerConeAngle", l->cutoff_deg * degree));
    json_t *node = json_pack("{s:{s:{s:i}}}", "extensions", "KHR_lights_punctual", "light",
                             (int)json_array_size(g->lights));
    if (!directional)
        json_object_set_new(node, "translation",
                            json_pack("[f,f,f]", l->position[0], l->position[1], l->position[2]));
    if (spot || directional) json_object_set_new(node, "rotation", rotation_to(l->direction));
    int bad = json_array_append_new(g->lights, o) | add_child(g, node);
    return bad ? igi_glb_full(g) : IGI_OK;
}

static void set_if_any(json_t *root, const char *key, json_t *array)
{
    if (json_array_size(array) > 0) json_object_set(root, key, array);
}

static json_t *make_root(const igi_glb *g)
{
    json_t *root = json_object();
    json_object_set_new(root, "asset",
                        json_pack("{s:s, s:s}", "version", "2.0", "generator", "igi"));
    json_t *used = json_pack("[s, s]", "KHR_materials_specular", "KHR_materials_emissive_strength");
    if (json_array_size(g->lights) > 0) {
        json_array_append_new(used, json_string("KHR_lights_punctual"));
        json_object_set_new(root, "extensions",
                            json_pack("{s:{s:O}}", "KHR_lights_punctual", "lights", g->lights));
    }
    json_object_set_new(root, "extensionsUsed", used);
    json_object_set_new(root, "scene", json_integer(0));
    json_object_set_new(root, "scenes",
                        json_pack("[{s:s?, s:[i]}]", "name", g->materials->scene, "nodes",
                                  (int)json_array_size(g->nodes) - 1));
    json_object_set(root, "nodes", g->nodes);
    set_if_any(root, "meshes", g->meshes);
    set_if_any(root, "materials", g->material_list);
    set_if_any(root, "textures", g->textures);
    set_if_any(root, "images", g->images);
    set_if_any(root, "accessors", g->accessors);
    set_if_any(root, "bufferViews", g->views);
    if (g->size > 0)
        json_object_set_new(root, "buffers",
                            json_pack("[{s:I}]", "byteLength", (json_int_t)g->size));
    return root;
}

static void put_u32(uint8_t *to, size_t x)
{
    for (int i = 0; i < 4; i++) to[i] = (uint8_t)(x >> (8 * i));
}

/* The header, the JSON chunk padded with blanks, the binary chunk. */
static igi_status write_file(const igi_glb *g, const char *path)
{
    json_t *root = make_root(g);
    char *json = json_dumps(root, JSON_COMPACT | JSON_REAL_PRECISION(9));
    json_decref(root);
    if (!json) return igi_glb_full(g);
    size_t length = strlen(json), padding = (4 - length % 4) % 4;
    size_t total = 12 + 8 + length + padding + (g->size ? 8 + g->size : 0);
    uint8_t head[20], binary[8];
    memcpy(head, "glTF\2\0\0\0", 8);
    put_u32(head + 8, total);
    put_u32(head + 12, length + padding);
    memcpy(head + 16, "JSON", 4);
    put_u32(binary, g->size);
    memcpy(binary + 4, "BIN\0", 4);
    igi_file file;
    igi_status status =
        total <= UINT32_MAX
            ? igi_file_begin(g->ctx, path, &file)
            : igi_fail(g->ctx, IGI_E_DATA,
                       "%s: above the 4 GB that a .glb holds; recover with a smaller --map-size",
                       path);
    if (status == IGI_OK) {
        (void)fwrite(head, 1, sizeof head, file.stream);
        (void)fwrite(json, 1, length, file.stream);
        (void)fwrite("   ", 1, padding, file.stream);
        if (g->size) (void)fwrite(binary, 1, 8, file.stream);
        if (g->size) (void)fwrite(g->bytes, 1, g->size, file.stream);
        status = igi_file_end(g->ctx, &file, IGI_OK);
    }
    json_free_t release;
    json_get_alloc_funcs(NULL, &release);
    release(json);
    return status;
}

static igi_status fill(igi_glb *g)
{
    for (size_t i = 0; i < g->materials->count; i++) IGI_TRY(add_region(g, i));
    for (size_t i = 0; i < g->materials->light_count; i++)
        IGI_TRY(add_light(g, &g->materials->lights[i]));
    json_t *root = json_pack("{s:s, s:[f,f,f,f]}", "name", "Z up", "rotation", -sqrt(.5), 0.0, 0.0,
                             sqrt(.5));
    set_if_any(root, "children", g->children);
    return json_array_append_new(g->nodes, root) ? igi_glb_full(g) : IGI_OK;
}

/* The same scene with texture coordinates for every textured region. */
static igi_status complete_uvs(igi_context *ctx, const igi_materials *materials,
                               const igi_scene *scene, igi_scene *full)
{
    igi_status status = IGI_OK;
    size_t triangles = scene->mesh.triangle_count;
    *full = *scene;
    full->regions = NULL;
    full->mesh.uvs = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->region_count, &full->regions));
    memcpy(full->regions, scene->regions, scene->region_count * sizeof *full->regions);
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 6 * triangles, &full->mesh.uvs));
    if (scene->mesh.uvs)
        memcpy(full->mesh.uvs, scene->mesh.uvs, 6 * triangles * sizeof *full->mesh.uvs);
    for (uint32_t r = 0; r < scene->region_count; r++) {
        igi_region *region = &full->regions[r];
        const igi_material *m = &materials->materials[r];
        region->has_uvs &= scene->mesh.uvs != NULL;
        if (region->has_uvs || m->emitter || !m->textured || !m->map) continue;
        IGI_TRY_GOTO(igi_atlas_fill(ctx, &scene->mesh, r, full->mesh.uvs));
        region->has_uvs = true;
        region->uvs_wrap = false;
    }
cleanup:
    return status;
}

igi_status igi_materials_save_glb(igi_context *ctx, const igi_materials *materials,
                                  const igi_scene *scene, const char *path)
{
    igi_scene full = {0};
    igi_glb g = {.ctx = ctx, .materials = materials, .scene = &full, .positions = -1};
    json_t **arrays[] = {&g.views,    &g.accessors, &g.meshes, &g.nodes,   &g.material_list,
                         &g.textures, &g.images,    &g.lights, &g.children};
    if (materials->count != scene->region_count)
        return igi_fail(ctx, IGI_E_USAGE, "scene.glb: %zu materials for %zu regions",
                        materials->count, scene->region_count);
    for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++) *arrays[i] = json_array();
    igi_status status = complete_uvs(ctx, materials, scene, &full);
    if (status == IGI_OK) status = fill(&g);
    if (status == IGI_OK) status = write_file(&g, path);
    for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++) json_decref(*arrays[i]);
    igi_free(g.bytes);
    igi_free(full.regions);
    igi_free(full.mesh.uvs);
    return status;
}
