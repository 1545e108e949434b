/* SPDX-License-Identifier: Apache-2.0
 *
 * OBJ with MTL: Kd and map_Kd, Ks for rho_s, Ns for the exponent whose Blinn-Phong lobe is as wide
 * as alpha (2/alpha^2 - 2), Ke for lamps, and Pr = sqrt(alpha), the roughness that physically based
 * readers take. Lights other than lamps have no words here.
 */
#include "export/export_private.h"
#include "base/file.h"

#include <math.h>

static void print_material(const igi_exporter *e, size_t region, const char *name, FILE *f)
{
    const igi_material *m = &e->materials->materials[region];
    const igi_light *lamp = m->emitter ? igi_export_lamp(e, region) : NULL;
    bool glossy = m->model != IGI_LAMBERT && !m->emitter;
    int bands = e->materials->bands;
    double flat[IGI_MAX_BANDS], kd[3] = {0, 0, 0}, ks[3];
    for (int b = 0; b < IGI_MAX_BANDS; b++) flat[b] = glossy ? m->specular : 0;
    if (!m->emitter) igi_export_rgb(m->albedo, bands, kd);
    igi_export_rgb(glossy && m->specular_is_rgb ? m->specular_rgb : flat, bands, ks);
    fprintf(f,
            "newmtl %s\nillum %d\nKa 0 0 0\nKd %.9g %.9g %.9g\nKs %.9g %.9g %.9g\nNs %.9g\n"
            "Pr %.9g\nPm 0\n",
            m->region, glossy ? 2 : 1, kd[0], kd[1], kd[2], ks[0], ks[1], ks[2],
            glossy ? 2 / (m->alpha * m->alpha) - 2 : 0, glossy ? sqrt(m->alpha) : 1.0);
    if (glossy) fprintf(f, "# igi: %s, alpha %.9g\n", igi_model_name(m->model), m->alpha);
    if (lamp) {
        double ke[3];
        igi_export_rgb(lamp->value, bands, ke);
        fprintf(f, "Ke %.9g %.9g %.9g\n", ke[0], ke[1], ke[2]);
    }
    if (igi_export_is_textured(e->scene, m, region)) fprintf(f, "map_Kd %s.png\n", name);
}

static igi_status write_materials(const igi_exporter *e)
{
    igi_status status = IGI_OK;
    char *path = NULL, *name = NULL;
    igi_file file = {0};
    IGI_TRY_GOTO(igi_strprintf(e->ctx, &path, "%s/scene.mtl", e->folder));
    IGI_TRY_GOTO(igi_file_begin(e->ctx, path, &file));
    for (size_t r = 0; r < e->scene->region_count; r++) {
        igi_free(name);
        name = NULL;
        IGI_TRY_GOTO(igi_region_file_name(e->ctx, e->scene->regions[r].name, &name));
        print_material(e, r, name, file.stream);
        if (igi_export_is_textured(e->scene, &e->materials->materials[r], r))
            IGI_TRY_GOTO(igi_export_texture(e, r, IGI_PICTURE_PNG, 1));
    }
cleanup:
    status = igi_file_end(e->ctx, &file, status);
    igi_free(path);
    igi_free(name);
    return status;
}

static void print_faces(const igi_exporter *e, size_t region, size_t *corner)
{
    const igi_mesh *mesh = &e->scene->mesh;
    bool has_uvs = mesh->uvs && e->scene->regions[region].has_uvs;
    fprintf(e->file, "usemtl %s\n", e->scene->regions[region].name);
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *v = mesh->triangles + 3 * t;
        if (mesh->regions[t] != region) continue;
        if (!has_uvs) {
            fprintf(e->file, "f %u %u %u\n", (unsigned)v[0] + 1, (unsigned)v[1] + 1,
                    (unsigned)v[2] + 1);
            continue;
        }
        const float *uv = mesh->uvs + 6 * t;
        for (int k = 0; k < 3; k++)
            fprintf(e->file, "vt %.9g %.9g\n", (double)uv[2 * k], (double)uv[2 * k + 1]);
        fprintf(e->file, "f %u/%zu %u/%zu %u/%zu\n", (unsigned)v[0] + 1, *corner + 1,
                (unsigned)v[1] + 1, *corner + 2, (unsigned)v[2] + 1, *corner + 3);
        *corner += 3;
    }
}

igi_status igi_write_obj(const igi_exporter *e)
{
    const igi_mesh *mesh = &e->scene->mesh;
    size_t corner = 0, lost = 0;
    for (size_t i = 0; i < e->materials->light_count; i++)
        lost += e->materials->lights[i].type != IGI_LIGHT_AREA;
    if (lost)
        igi_warn(e->ctx, "OBJ knows no lights but glowing surfaces: %zu %s left out", lost,
                 lost == 1 ? "light is" : "lights are");
    IGI_TRY(write_materials(e));
    fprintf(e->file, "mtllib %s/scene.mtl\n", e->files);
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        const float *p = mesh->positions + 3 * i;
        fprintf(e->file, "v %.9g %.9g %.9g\n", (double)p[0], (double)p[1], (double)p[2]);
    }
    for (size_t r = 0; r < e->scene->region_count; r++) print_faces(e, r, &corner);
    return IGI_OK;
}
