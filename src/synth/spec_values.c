/* SPDX-License-Identifier: Apache-2.0
 *
 * Values of the spec: numbers in their ranges, vectors, reflectances.
 */
#include "synth/synth.h"

#include "scene/light_colour.h"

#include <math.h>

igi_status optional_number(igi_context *ctx, const igi_json *object, const char *key, double low,
                           double high, double *value)
{
    igi_json at = igi_json_member(object, key);
    if (!at.value) return IGI_OK;
    IGI_TRY(igi_json_number(ctx, &at, value));
    if (!(*value >= low && *value <= high))
        return igi_json_fail(ctx, &at, "is %g; give a number from %g to %g", *value, low, high);
    return IGI_OK;
}

igi_status optional_int(igi_context *ctx, const igi_json *object, const char *key, int low,
                        int high, int *value)
{
    double number = *value;
    IGI_TRY(optional_number(ctx, object, key, low, high, &number));
    igi_json at = igi_json_member(object, key);
    if (number != floor(number))
        return igi_json_fail(ctx, &at, "is %g; give a whole number", number);
    *value = (int)number;
    return IGI_OK;
}

igi_status member_vector(igi_context *ctx, const igi_json *object, const char *key, double value[3])
{
    igi_json at = igi_json_member(object, key);
    return igi_json_numbers(ctx, &at, 3, value);
}

igi_status read_bands(igi_context *ctx, const igi_json *at, int bands, double *value)
{
    if (json_is_object(at->value)) {
        static const char *const known[] = {"hsv"};
        igi_json hsv = igi_json_member(at, "hsv");
        IGI_TRY(igi_json_check_keys(ctx, at, known, 1));
        if (bands != 3) return igi_json_fail(ctx, at, "is for 3 bands (RGB), these are %d", bands);
        IGI_TRY(igi_json_hsv(ctx, &hsv, value));
    } else if (json_is_array(at->value)) {
        IGI_TRY(igi_json_numbers(ctx, at, (size_t)bands, value));
    } else {
        IGI_TRY(igi_json_number(ctx, at, &value[0]));
        for (int b = 1; b < bands; b++) value[b] = value[0];
    }
    for (int b = 0; b < bands; b++)
        if (!(value[b] >= 0 && value[b] <= 1))
            return igi_json_fail(ctx, at, "is %g in band %d; a surface reflects from 0 to 1",
                                 value[b], b);
    return IGI_OK;
}
