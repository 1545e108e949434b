/* SPDX-License-Identifier: Apache-2.0 */
#include "scene/light_place.h"

#include <math.h>
#include <string.h>

size_t igi_light_place_keys(unsigned keys, const char **names)
{
    static const struct {
        unsigned keys;
        const char *name;
    } all[IGI_LIGHT_PLACE_KEYS] = {{IGI_PLACE_POSITION, "position"},
                                   {IGI_PLACE_FROM_TO, "from"},
                                   {IGI_PLACE_FROM_TO, "to"},
                                   {IGI_PLACE_POSITION | IGI_PLACE_FROM_TO, "position_std"},
                                   {IGI_PLACE_DIRECTION, "direction"},
                                   {IGI_PLACE_CONE, "cutoff_deg"},
                                   {IGI_PLACE_CONE, "beam_deg"}};
    size_t count = 0;
    for (size_t i = 0; i < IGI_LIGHT_PLACE_KEYS; i++)
        if (keys & all[i].keys) names[count++] = all[i].name;
    return count;
}

static igi_status read_vector(igi_context *ctx, const igi_json *at, const char *key,
                              double vector[3])
{
    igi_json member = igi_json_member(at, key);
    return igi_json_numbers(ctx, &member, 3, vector);
}

static igi_status read_direction(igi_context *ctx, const igi_json *at, double direction[3])
{
    IGI_TRY(read_vector(ctx, at, "direction", direction));
    double length = sqrt(direction[0] * direction[0] + direction[1] * direction[1] +
                         direction[2] * direction[2]);
    igi_json member = igi_json_member(at, "direction");
    if (!(length > 1e-9 && length < 1e100))
        return igi_json_fail(ctx, &member,
                             "has no length; give the way in which the light travels");
    for (int k = 0; k < 3; k++) direction[k] /= length;
    return IGI_OK;
}

/* How well the place is known: to be refined by the photographs. */
static igi_status read_position_std(igi_context *ctx, const igi_json *at, igi_light *light)
{
    igi_json member = igi_json_member(at, "position_std");
    double std;
    if (!member.value) return IGI_OK;
    IGI_TRY(igi_json_number(ctx, &member, &std));
    if (!(std > 0 && std < 1e3))
        return igi_json_fail(
            ctx, &member,
            "is %g; give a standard deviation in metres, or leave it out where the "
            "place is known",
            std);
    for (int k = 0; k < 3; k++) light->position_std[k] = std;
    return IGI_OK;
}

static igi_status read_cone(igi_context *ctx, const igi_json *at, igi_light *light)
{
    igi_json cutoff = igi_json_member(at, "cutoff_deg"), beam = igi_json_member(at, "beam_deg");
    IGI_TRY(igi_json_number(ctx, &cutoff, &light->cutoff_deg));
    if (!(light->cutoff_deg > 0 && light->cutoff_deg <= 180))
        return igi_json_fail(ctx, &cutoff, "is %g; give a half angle above 0, up to 180 degrees",
                             light->cutoff_deg);
    light->beam_deg = light->cutoff_deg;
    if (!beam.value) return IGI_OK;
    IGI_TRY(igi_json_number(ctx, &beam, &light->beam_deg));
    if (!(light->beam_deg >= 0 && light->beam_deg <= light->cutoff_deg))
        return igi_json_fail(ctx, &beam, "is %g; give a half angle from 0 to cutoff_deg",
                             light->beam_deg);
    return IGI_OK;
}

igi_status igi_light_read_place(igi_context *ctx, const igi_json *at, unsigned keys,
                                igi_light *light)
{
    if (keys & IGI_PLACE_POSITION) IGI_TRY(read_vector(ctx, at, "position", light->position));
    if (keys & IGI_PLACE_FROM_TO) {
        IGI_TRY(read_vector(ctx, at, "from", light->position));
        IGI_TRY(read_vector(ctx, at, "to", light->end));
        if (memcmp(light->position, light->end, sizeof light->end) == 0)
            return igi_json_fail(ctx, at,
                                 "\"from\" and \"to\" are one point; give the line's ends");
    }
    IGI_TRY(read_position_std(ctx, at, light));
    if (keys & IGI_PLACE_DIRECTION) IGI_TRY(read_direction(ctx, at, light->direction));
    if (keys & IGI_PLACE_CONE) IGI_TRY(read_cone(ctx, at, light));
    return IGI_OK;
}
