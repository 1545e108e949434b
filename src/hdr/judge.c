/* SPDX-License-Identifier: Apache-2.0
 *
 * What may be wrong with a bracket, said by name: false exposures, one picture twice, no light.
 */
#include "base/file.h"
#include "hdr/bracket_private.h"

#include <math.h>
#include <stdio.h>

/* A third of a stop: cameras round their times by less. */
#define FALSE_RATIO (.693147 / 3)
/* Of the range of codes: a picture that has none above shows no light, but noise. */
#define BLACK_8_BITS .03
#define BLACK_16_BITS .002

igi_status igi_hdr_refuse_twins(igi_context *ctx, const job *j, size_t i, const igi_photo *before,
                                const igi_photo *photo)
{
    size_t samples = (size_t)photo->width * (size_t)photo->height * (size_t)photo->channels;
    if (j->frames[i].h != j->frames[i - 1].h ||
        memcmp(photo->codes, before->codes, samples * sizeof *photo->codes) != 0)
        return IGI_OK;
    return igi_fail(ctx, IGI_E_DATA,
                    "%s: the same picture as %s: twice it would count as two; name it once",
                    j->frames[i].exposure->path, igi_file_name(j->frames[i - 1].exposure->path));
}

igi_status igi_hdr_judge_light(igi_context *ctx, const job *j, char **warning)
{
    const char *first = j->frames[0].exposure->path;
    if (j->bracket.unsaturated[0] == 0)
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: saturated everywhere, and it is the shortest exposure; take shorter "
                        "ones",
                        first);
    if (j->brightest < (j->bracket.levels == 256 ? BLACK_8_BITS : BLACK_16_BITS))
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: black everywhere, and it is the longest exposure; take longer ones",
                        j->frames[j->bracket.count - 1].exposure->path);
    if (!j->guessed) return IGI_OK;
    return igi_strprintf(ctx, warning,
                         "%s: one photograph alone tells no response: sRGB's is assumed; take a "
                         "bracket, or give --response",
                         first);
}

/* Appends what is wrong with a pair; false when the sentence is full. */
static bool describe(const job *j, size_t pair, double seen, char *sentence, size_t size)
{
    const igi_bracket *bracket = &j->bracket;
    size_t length = strlen(sentence);
    if (length + 200 > size) return false;
    snprintf(sentence + length, size - length,
             "%s%.60s is stated to have %.2f times the exposure of %.60s and shows %.2f",
             length ? ", " : "", igi_file_name(j->frames[pair + 1].exposure->path),
             exp(bracket->log_h[pair + 1] - bracket->log_h[pair]),
             igi_file_name(j->frames[pair].exposure->path), exp(seen));
    return true;
}

igi_status igi_hdr_judge_exposures(igi_context *ctx, job *j, char **warning)
{
    igi_bracket *bracket = &j->bracket;
    char wrong[800] = "", odd[800] = "";
    size_t first = SIZE_MAX, more = 0;
    for (size_t p = 0; p + 1 < bracket->count; p++) {
        double stated = bracket->log_h[p + 1] - bracket->log_h[p], seen = bracket->log_ratio[p];
        if (isnan(seen) || fabs(seen - stated) <= FALSE_RATIO) continue;
        bool camera = j->frames[p].exposure->from_camera && j->frames[p + 1].exposure->from_camera;
        if (camera && fabs(seen) > .02) {
            (void)describe(j, p, seen, odd, sizeof odd);
            bracket->log_ratio[p] = stated;
            continue;
        }
        if (first == SIZE_MAX) first = p;
        more += !describe(j, p, seen, wrong, sizeof wrong);
    }
    if (first != SIZE_MAX)
        return igi_fail(
            ctx, IGI_E_DATA, "%s: false exposures: %s%s; correct the times%s",
            j->frames[first + 1].exposure->path, wrong, more ? ", and more" : "",
            j->taken_as_linear
                ? ", or say --response recovered: codes of 16 bits are taken as linear, "
                  "and a developed picture has a tone curve"
                : "");
    if (!odd[0]) return IGI_OK;
    return igi_strprintf(ctx, warning,
                         "the camera processed the photographs differently (%s): the radiance is "
                         "rough; merge raw files where you have them",
                         odd);
}
