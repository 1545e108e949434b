/* SPDX-License-Identifier: Apache-2.0
 *
 * Debevec's and Robertson's methods as OpenCV has them, for comparison: all photographs in memory,
 * 8-bit colour.
 */
#include "base/context.h"
#include "bridge/opencv.h"
#include "hdr/hdr_private.h"

#include <math.h>

typedef struct stack {
    igi_cv_bracket bracket;
    uint8_t **photos;
    float *times;
} stack;

static void free_stack(stack *s)
{
    for (size_t i = 0; s->photos && i < s->bracket.count; i++) igi_free(s->photos[i]);
    igi_free(s->photos);
    igi_free(s->times);
}

static igi_status add_photo(igi_context *ctx, stack *s, size_t index, const char *path)
{
    igi_photo *photo = NULL;
    IGI_TRY(igi_photo_load(ctx, path, &photo));
    igi_status status = IGI_OK;
    size_t count = (size_t)photo->width * (size_t)photo->height * 3;
    if (index == 0) {
        s->bracket.width = photo->width;
        s->bracket.height = photo->height;
    }
    if (photo->channels != 3 || photo->levels != 256 || photo->width != s->bracket.width ||
        photo->height != s->bracket.height)
        status = igi_fail(ctx, IGI_E_DATA,
                          "%s: Debevec's and Robertson's methods take 8-bit colour photographs of "
                          "one size; leave the method at its default",
                          path);
    else status = IGI_ALLOC(ctx, count, &s->photos[index]);
    for (size_t i = 0; status == IGI_OK && i < count; i++)
        s->photos[index][i] = (uint8_t)photo->codes[i];
    igi_photo_destroy(photo);
    return status;
}

static igi_status load_stack(igi_context *ctx, const igi_exposure *exposures, size_t count,
                             stack *s)
{
    IGI_TRY(IGI_ALLOC(ctx, count, &s->photos));
    s->bracket.count = count;
    IGI_TRY(IGI_ALLOC(ctx, count, &s->times));
    for (size_t i = 0; i < count; i++) {
        s->times[i] = (float)igi_hdr_exposure(&exposures[i]);
        IGI_TRY(add_photo(ctx, s, i, exposures[i].path));
    }
    s->bracket.photos = (const uint8_t *const *)s->photos;
    s->bracket.times_s = s->times;
    return IGI_OK;
}

igi_status igi_hdr_compare_response(igi_context *ctx, const igi_exposure *exposures, size_t count,
                                    bool robertson, igi_response **response)
{
    igi_status status = IGI_OK;
    stack s = {0};
    float curve[256 * 3];
    *response = NULL;
    IGI_TRY_GOTO(load_stack(ctx, exposures, count, &s));
    IGI_TRY_GOTO(igi_cv_response(ctx, &s.bracket, robertson, curve));
    IGI_TRY_GOTO(igi_response_create(ctx, 3, 256, response));
    for (int c = 0; c < 3; c++) {
        float *to = (*response)->exposure + c * 256, top = 0;
        /* Codes that the bracket lacks come out as NaN or 0: the last known value stands. */
        for (int z = 0; z < 256; z++) {
            float x = curve[3 * z + c];
            to[z] = isfinite(x) && x > top ? x : top;
            top = to[z];
        }
        for (int z = 0; z < 256; z++) to[z] = top > 0 ? to[z] / top : (float)z / 255;
        (*response)->low[c] = 1;
        (*response)->high[c] = 254;
    }
cleanup:
    free_stack(&s);
    return status;
}

igi_status igi_hdr_compare_merge(igi_context *ctx, const igi_exposure *exposures, size_t count,
                                 const igi_response *response, bool robertson, igi_image **image)
{
    igi_status status = IGI_OK;
    stack s = {0};
    float curve[256 * 3];
    *image = NULL;
    IGI_TRY_GOTO(load_stack(ctx, exposures, count, &s));
    for (int z = 0; z < 256; z++) /* the logarithm of 0 is no help to Debevec's method */
        for (int c = 0; c < 3; c++)
            curve[3 * z + c] = fmaxf(response->exposure[c * 256 + z], 1e-6f);
    IGI_TRY_GOTO(igi_image_create(ctx, s.bracket.width, s.bracket.height, 3, image));
    IGI_TRY_GOTO(igi_cv_merge(ctx, &s.bracket, curve, robertson, (*image)->samples));
cleanup:
    if (status != IGI_OK) {
        igi_image_destroy(*image);
        *image = NULL;
    }
    free_stack(&s);
    return status;
}
