/* SPDX-License-Identifier: Apache-2.0
 *
 * A region's triangles as binary PLY: vertices of their own for each corner, so that nothing
 * smooths normals across edges and texture coordinates belong to corners.
 */
#include "export/export_private.h"
#include "base/file.h"

#include <string.h>

static void put_floats(FILE *f, const float *x, int count)
{
    for (int i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &x[i], sizeof bits);
        for (int k = 0; k < 4; k++) putc((int)(bits >> (8 * k) & 255), f);
    }
}

static void put_index(FILE *f, size_t i)
{
    for (int k = 0; k < 4; k++) putc((int)(i >> (8 * k) & 255), f);
}

static void print_ply(const igi_exporter *e, size_t region, FILE *f)
{
    const igi_mesh *mesh = &e->scene->mesh;
    bool textured = igi_export_is_textured(e->scene, &e->materials->materials[region], region);
    size_t count = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) count += mesh->regions[t] == region;
    fprintf(f,
            "ply\nformat binary_little_endian 1.0\nelement vertex %zu\nproperty float x\n"
            "property float y\nproperty float z\n%selement face %zu\n"
            "property list uchar int vertex_indices\nend_header\n",
            3 * count, textured ? "property float u\nproperty float v\n" : "", count);
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
        if (mesh->regions[i / 3] != region) continue;
        put_floats(f, mesh->positions + 3 * (size_t)mesh->triangles[i], 3);
        if (textured) put_floats(f, mesh->uvs + 2 * i, 2);
    }
    for (size_t t = 0; t < count; t++) {
        putc(3, f);
        for (size_t k = 0; k < 3; k++) put_index(f, 3 * t + k);
    }
}

igi_status igi_export_ply(const igi_exporter *e, size_t region)
{
    igi_status status = IGI_OK;
    char *name = NULL, *path = NULL;
    igi_file file;
    IGI_TRY_GOTO(igi_region_file_name(e->ctx, e->scene->regions[region].name, &name));
    IGI_TRY_GOTO(igi_strprintf(e->ctx, &path, "%s/%s.ply", e->folder, name));
    IGI_TRY_GOTO(igi_file_begin(e->ctx, path, &file));
    print_ply(e, region, file.stream);
    status = igi_file_end(e->ctx, &file, IGI_OK);
cleanup:
    igi_free(name);
    igi_free(path);
    return status;
}
