/* SPDX-License-Identifier: Apache-2.0
 *
 * Textures and environment maps as files: PNG, OpenEXR, and Radiance's HDR (a shared exponent:
 * each component within half a per cent; Ward, "Real pixels", 1991).
 */
#include "export/export_private.h"
#include "base/file.h"
#include "image/srgb.h"
#include "light/sky.h"
#include "scene/file_text.h"

#include <math.h>
#include <string.h>

static igi_status save_hdr(igi_context *ctx, const igi_image *rgb, const char *path)
{
    size_t pixels = (size_t)rgb->width * (size_t)rgb->height, head;
    uint8_t *bytes;
    char text[128];
    head = (size_t)snprintf(text, sizeof text,
                            "#?RADIANCE\nSOFTWARE=igi\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n",
                            rgb->height, rgb->width);
    IGI_TRY(IGI_ALLOC(ctx, head + 4 * pixels, &bytes));
    memcpy(bytes, text, head);
    for (size_t i = 0; i < pixels; i++) igi_rgbe(rgb->samples + 3 * i, bytes + head + 4 * i);
    igi_status status = igi_file_save(ctx, path, bytes, head + 4 * pixels);
    igi_free(bytes);
    return status;
}

/* R G B of an image with any bands, each times its own scale. */
static igi_status take_rgb(igi_context *ctx, const igi_image *image, int bands,
                           const double scale[3], igi_image **rgb)
{
    IGI_TRY(igi_image_create(ctx, image->width, image->height, 3, rgb));
    size_t values = 3 * (size_t)image->width * (size_t)image->height;
    for (size_t i = 0; i < values; i++) {
        int k = (int)(i % 3), band = k < bands ? k : bands - 1;
        float x = image->samples[i / 3 * (size_t)image->channels + (size_t)band];
        (*rgb)->samples[i] = (float)((double)x * scale[k]);
    }
    return IGI_OK;
}

static igi_status save_rgb(igi_context *ctx, const igi_image *rgb, igi_picture format,
                           const char *path)
{
    if (format == IGI_PICTURE_EXR) return igi_image_save_exr(ctx, rgb, IGI_EXR_HALF, path);
    if (format == IGI_PICTURE_HDR) return save_hdr(ctx, rgb, path);
    uint8_t *png = NULL;
    size_t size;
    IGI_TRY(igi_srgb_png(ctx, rgb, 3, 1, &png, &size));
    igi_status status = igi_file_save(ctx, path, png, size);
    igi_image_free_bytes(png);
    return status;
}

static const char *ending(igi_picture format)
{
    return format == IGI_PICTURE_PNG ? "png" : format == IGI_PICTURE_EXR ? "exr" : "hdr";
}

igi_status igi_export_texture(const igi_exporter *e, size_t region, igi_picture format,
                              double scale)
{
    igi_status status = IGI_OK;
    char *name = NULL, *path = NULL;
    igi_image *rgb = NULL;
    const double scales[3] = {scale, scale, scale};
    IGI_TRY_GOTO(igi_region_file_name(e->ctx, e->scene->regions[region].name, &name));
    IGI_TRY_GOTO(igi_strprintf(e->ctx, &path, "%s/%s.%s", e->folder, name, ending(format)));
    IGI_TRY_GOTO(
        take_rgb(e->ctx, e->materials->materials[region].map, e->materials->bands, scales, &rgb));
    status = save_rgb(e->ctx, rgb, format, path);
cleanup:
    igi_image_destroy(rgb);
    igi_free(name);
    igi_free(path);
    return status;
}

igi_status igi_export_sky(const igi_exporter *e, size_t light, igi_picture format, int size[2])
{
    igi_status status = IGI_OK;
    const igi_light *l = &e->materials->lights[light];
    char *path = NULL;
    igi_image *image = NULL, *rgb = NULL;
    double scale[3];
    igi_export_rgb(l->value, e->materials->bands, scale);
    if (l->sky.given)
        IGI_TRY_GOTO(
            igi_fail(e->ctx, IGI_E_DATA,
                     "lights[%zu]: a sky by the sun's place is not exported to this format; "
                     "remove it from materials.json",
                     light));
    IGI_TRY_GOTO(igi_image_load_exr(e->ctx, l->file ? l->file : "", &image));
    int bands = image->channels - (strcmp(image->names[image->channels - 1], "A") == 0);
    IGI_TRY_GOTO(take_rgb(e->ctx, image, bands, scale, &rgb));
    IGI_TRY_GOTO(igi_strprintf(e->ctx, &path, "%s/light_%zu.%s", e->folder, light, ending(format)));
    IGI_TRY_GOTO(save_rgb(e->ctx, rgb, format, path));
    size[0] = rgb->width;
    size[1] = rgb->height;
cleanup:
    igi_image_destroy(image);
    igi_image_destroy(rgb);
    igi_free(path);
    return status;
}

/* From [0,1]^2 to the sphere, equal areas to equal areas: the square's diamond is the upper half,
 * its corners fold down (Clarberg, "Fast equal-area mapping of the (hemi)sphere", 2008). */
static igi_vec square_direction(float x, float y)
{
    float u = 2 * x - 1, v = 2 * y - 1, a = fabsf(u), b = fabsf(v);
    float signed_distance = 1 - (a + b), d = fabsf(signed_distance), r = 1 - d;
    float phi = (r == 0 ? 1 : (b - a) / r + 1) * IGI_PIF / 4;
    float z = copysignf(1 - r * r, signed_distance), flat = r * sqrtf(fmaxf(0, 2 - r * r));
    return igi_v(copysignf(cosf(phi), u) * flat, copysignf(sinf(phi), v) * flat, z);
}

igi_status igi_export_square_sky(const igi_exporter *e, size_t light)
{
    enum { SIDE = 512 };
    igi_status status = IGI_OK;
    const igi_light *l = &e->materials->lights[light];
    sky *from = NULL;
    igi_image *rgb = NULL;
    char *path = NULL;
    int bands = e->materials->bands;
    double scale[3];
    igi_export_rgb(l->value, bands, scale);
    IGI_TRY_GOTO(sky_of_light(e->ctx, l, bands, &from));
    IGI_TRY_GOTO(igi_image_create(e->ctx, SIDE, SIDE, 3, &rgb));
    for (size_t i = 0; i < (size_t)SIDE * SIDE; i++) {
        /* Row 0 of the file is y = 0: pbrt looks maps up without turning them over. */
        igi_vec d = square_direction(((float)(i % SIDE) + 0.5f) / SIDE,
                                     ((float)(i / SIDE) + 0.5f) / SIDE);
        const float *seen = sky_radiance(from, d);
        for (int k = 0; k < 3; k++)
            rgb->samples[3 * i + (size_t)k] = seen[k < bands ? k : bands - 1] * (float)scale[k];
    }
    IGI_TRY_GOTO(igi_strprintf(e->ctx, &path, "%s/light_%zu.exr", e->folder, light));
    status = igi_image_save_exr(e->ctx, rgb, IGI_EXR_HALF, path);
cleanup:
    sky_destroy(from);
    igi_image_destroy(rgb);
    igi_free(path);
    return status;
}
