/* SPDX-License-Identifier: Apache-2.0 */
#include "specular/highlights_private.h"

static float pixel_angle(const igi_scene *scene)
{
    double sum = 0;
    for (size_t f = 0; f < scene->frame_count; f++) sum += 1 / scene->frames[f].camera.fl_x;
    return (float)(sum / (double)scene->frame_count);
}

igi_status igi_highlights_create(igi_context *ctx, const igi_highlight_source *source,
                                 const igi_highlight_scores *scores,
                                 const igi_highlight_options *options, const igi_highlights *fewer,
                                 igi_highlights **highlights)
{
    const igi_problem *p = source->field->problem;
    igi_status status = IGI_OK;
    igi_highlights *h = NULL;
    *highlights = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &h));
    h->bands = p->bands;
    h->lobe_samples = options->lobe_samples;
    h->samples = options->lobe_samples + (int)source->rows->lights * options->lamp_samples +
                 options->sharp_samples;
    h->pixel_angle = pixel_angle(p->scene);
    IGI_TRY_GOTO(igi_highlights_choose(ctx, p, scores, options, h));
    IGI_TRY_GOTO(igi_highlights_light(ctx, source, scores->region, options, fewer, h));
    *highlights = h;
    h = NULL;
cleanup:
    igi_highlights_destroy(h);
    return status;
}

void igi_highlights_destroy(igi_highlights *highlights)
{
    if (!highlights) return;
    igi_free(highlights->group);
    igi_free(highlights->observation);
    igi_free(highlights->piece);
    igi_free(highlights->radiance);
    igi_free(highlights->irradiance);
    igi_free(highlights->directions);
    igi_free(highlights->incident);
    igi_free(highlights);
}
