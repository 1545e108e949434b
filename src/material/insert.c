/* SPDX-License-Identifier: Apache-2.0
 *
 * Another mesh in a scene: its regions are new ones, made of what its MTL says.
 *
 * Of MTL: Kd is rho_d, Ks rho_s. The roughness is Pr = sqrt(alpha) where it is given, else Ns is the
 * exponent of a Blinn-Phong lobe as wide as alpha = sqrt(2/(Ns + 2)). A lobe is ggx. Ke makes a lamp;
 * its light is the caller's to list.
 */
#include "material/material.h"
#include "material/result.h"
#include "scene/file_text.h"
#include "scene/mesh.h"

#include <math.h>
#include <string.h>

#define DEFAULT_ALBEDO 0.5
#define MAX_MTL_BYTES ((size_t)1 << 24)

static igi_status default_material(igi_context *ctx, const char *region, igi_material *m)
{
    *m = (igi_material){.model = IGI_LAMBERT, .determined = true, .observed = 1};
    for (int b = 0; b < IGI_MAX_BANDS; b++) m->albedo[b] = DEFAULT_ALBEDO;
    return igi_strdup(ctx, region, &m->region);
}

/* A line of the text without its end; false after the last. */
static bool next_line(const char **at, char *line, size_t size)
{
    if (!**at) return false;
    size_t length = strcspn(*at, "\r\n");
    size_t kept = length < size ? length : size - 1;
    memcpy(line, *at, kept);
    line[kept] = 0;
    while (kept > 0 && (line[kept - 1] == ' ' || line[kept - 1] == '\t')) line[--kept] = 0;
    *at += length + strspn(*at + length, "\r\n");
    return true;
}

/* What follows the keyword, or NULL. */
static const char *value_of(const char *line, const char *keyword)
{
    line += strspn(line, " \t");
    size_t length = strlen(keyword);
    if (strncmp(line, keyword, length) != 0 || !strchr(" \t", line[length])) return NULL;
    return line + length + strspn(line + length, " \t");
}

static int scan_numbers(const char *text, double x[3])
{
    int count = 0;
    while (text && count < 3 && igi_scan_number(&text, &x[count])) {
        text += strspn(text, " \t");
        if (!isfinite(x[count]) || x[count] < 0) return 0;
        count++;
    }
    for (int k = count; k < 3 && count > 0; k++) x[k] = x[0];
    return count;
}

static void set_lobe(igi_material *m, const double rgb[3], int bands)
{
    double largest = fmax(rgb[0], fmax(rgb[1], rgb[2]));
    if (!(largest > 0)) return;
    m->model = IGI_GGX;
    m->specular = fmin(1, (rgb[0] + rgb[1] + rgb[2]) / 3);
    m->specular_is_rgb = bands >= 3 && (rgb[0] != rgb[1] || rgb[0] != rgb[2]);
    for (int b = 0; b < bands; b++) m->specular_rgb[b] = fmin(1, rgb[b < 3 ? b : 2]);
    if (!(m->alpha > 0)) m->alpha = 0.3;
}

static double roughness_to_alpha(double root)
{
    return fmin(1, fmax(1e-3, root * root));
}

/* One line of a material's. */
static void read_entry(const char *line, int bands, bool *has_pr, igi_material *m)
{
    double x[3];
    if (scan_numbers(value_of(line, "Kd"), x))
        for (int b = 0; b < bands; b++) m->albedo[b] = fmin(1, x[b < 3 ? b : 2]);
    if (scan_numbers(value_of(line, "Ks"), x)) set_lobe(m, x, bands);
    if (scan_numbers(value_of(line, "Pr"), x)) {
        *has_pr = true;
        m->alpha = roughness_to_alpha(x[0]);
    }
    if (!*has_pr && scan_numbers(value_of(line, "Ns"), x))
        m->alpha = fmin(1, fmax(1e-3, sqrt(2 / (x[0] + 2))));
    if (scan_numbers(value_of(line, "Ke"), x)) m->emitter |= x[0] + x[1] + x[2] > 0;
}

static void read_mtl(const char *text, int bands, igi_material *materials, size_t count)
{
    igi_material *m = NULL;
    bool has_pr = false;
    char line[1024];
    while (next_line(&text, line, sizeof line)) {
        const char *name = value_of(line, "newmtl");
        if (name) m = NULL;
        for (size_t i = 0; name && i < count; i++)
            if (strcmp(materials[i].region, name) == 0) m = &materials[i];
        if (name) has_pr = false;
        else if (m) read_entry(line, bands, &has_pr, m);
    }
}

static igi_status load_mtl(igi_context *ctx, const char *path, int bands, igi_material *materials,
                           size_t count)
{
    igi_status status = IGI_OK;
    igi_text obj = {0}, mtl = {0};
    char *folder = NULL, *library = NULL, line[1024];
    const char *named = NULL;
    if (!igi_ends_with(path, ".obj")) return IGI_OK;
    IGI_TRY_GOTO(igi_text_load(ctx, path, (size_t)1 << 31, &obj));
    const char *at = obj.bytes;
    while (!named && next_line(&at, line, sizeof line)) named = value_of(line, "mtllib");
    if (!named) {
        igi_warn(ctx,
                 "%s: names no mtllib: its surfaces are grey, %g, where --materials says no "
                 "other",
                 path, DEFAULT_ALBEDO);
        goto cleanup;
    }
    IGI_TRY_GOTO(igi_path_folder(ctx, path, &folder));
    IGI_TRY_GOTO(igi_path_join(ctx, folder, named, &library));
    IGI_TRY_GOTO(igi_text_load(ctx, library, MAX_MTL_BYTES, &mtl));
    read_mtl(mtl.bytes, bands, materials, count);
cleanup:
    igi_free(obj.bytes);
    igi_free(mtl.bytes);
    igi_free(folder);
    igi_free(library);
    return status;
}

/* An array of `a` + `b` elements in place of `old`, the second part from `more` (NULL: zeroes). NULL
 * when there is no memory; `old` is then still the caller's. */
static void *append(igi_context *ctx, void *old, size_t a, const void *more, size_t b, size_t size)
{
    char *joined = igi_calloc(ctx, a + b, size);
    if (!joined) return NULL;
    if (old) memcpy(joined, old, a * size);
    if (more) memcpy(joined + a * size, more, b * size);
    igi_free(old);
    return joined;
}

static igi_status append_mesh(igi_context *ctx, igi_scene *scene, igi_scene *other)
{
    igi_mesh *m = &scene->mesh, *n = &other->mesh;
    for (size_t i = 0; i < 3 * n->triangle_count; i++) n->triangles[i] += (uint32_t)m->vertex_count;
    for (size_t i = 0; i < n->triangle_count; i++) n->regions[i] += (uint32_t)scene->region_count;
    if (m->vertex_count + n->vertex_count > UINT32_MAX)
        return igi_fail(ctx, IGI_E_DATA, "the scene becomes larger than igi renders");
    void *grown = append(ctx, m->positions, 3 * m->vertex_count, n->positions, 3 * n->vertex_count,
                         sizeof(float));
    if (!grown) return IGI_E_SYSTEM;
    m->positions = grown;
    grown = append(ctx, m->triangles, 3 * m->triangle_count, n->triangles, 3 * n->triangle_count,
                   sizeof(uint32_t));
    if (!grown) return IGI_E_SYSTEM;
    m->triangles = grown;
    grown = append(ctx, m->regions, m->triangle_count, n->regions, n->triangle_count,
                   sizeof(uint32_t));
    if (!grown) return IGI_E_SYSTEM;
    m->regions = grown;
    if (m->uvs) { /* zeroes for the new ones: they have no maps */
        grown = append(ctx, m->uvs, 6 * m->triangle_count, NULL, 6 * n->triangle_count,
                       sizeof(float));
        if (!grown) return IGI_E_SYSTEM;
        m->uvs = grown;
    }
    m->vertex_count += n->vertex_count;
    m->triangle_count += n->triangle_count;
    return IGI_OK;
}

/* The names move from the one to the other. */
static igi_status append_regions(igi_context *ctx, igi_scene *scene, igi_scene *other)
{
    void *grown = append(ctx, scene->regions, scene->region_count, other->regions,
                         other->region_count, sizeof(igi_region));
    if (!grown) return IGI_E_SYSTEM;
    scene->regions = grown;
    for (size_t i = 0; i < other->region_count; i++)
        scene->regions[scene->region_count + i].has_uvs = false;
    scene->region_count += other->region_count;
    other->region_count = 0;
    return IGI_OK;
}

static igi_status check_names(igi_context *ctx, const igi_scene *scene, const igi_scene *other,
                              const char *path)
{
    for (size_t i = 0; i < other->region_count; i++)
        for (size_t k = 0; k < scene->region_count; k++)
            if (strcmp(scene->regions[k].name, other->regions[i].name) == 0)
                return igi_fail(ctx, IGI_E_DATA,
                                "%s: its material '%s' is a region of the scene already; rename it",
                                path, other->regions[i].name);
    return IGI_OK;
}

igi_status igi_result_insert(igi_context *ctx, igi_scene *scene, igi_materials *materials,
                             const char *path)
{
    igi_status status = IGI_OK;
    igi_scene *other = NULL;
    igi_material *added = NULL;
    size_t count = 0;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &other));
    IGI_TRY_GOTO(igi_mesh_load(ctx, other, path));
    IGI_TRY_GOTO(check_names(ctx, scene, other, path));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, other->region_count, &added));
    for (; count < other->region_count; count++)
        IGI_TRY_GOTO(default_material(ctx, other->regions[count].name, &added[count]));
    IGI_TRY_GOTO(load_mtl(ctx, path, materials->bands, added, count));
    for (size_t i = 0; i < count; i++) other->regions[i].emitter = added[i].emitter;
    void *grown = append(ctx, materials->materials, materials->count, added, count,
                         sizeof(igi_material));
    if (!grown) IGI_TRY_GOTO(IGI_E_SYSTEM);
    materials->materials = grown;
    materials->count += count;
    count = 0; /* they are the materials' now */
    IGI_TRY_GOTO(append_mesh(ctx, scene, other));
    status = append_regions(ctx, scene, other);
cleanup:
    for (size_t i = 0; added && i < count; i++) igi_material_clear(&added[i]);
    igi_free(added);
    igi_scene_destroy(other);
    return status;
}
