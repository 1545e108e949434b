/* SPDX-License-Identifier: Apache-2.0
 *
 * The Astronomical Almanac's low-precision sun (Michalsky, Solar Energy 40, 1988).
 */
#include "scene/sun.h"

#include <math.h>
#include <stdio.h>

#define RADIANS 0.017453292519943295

void igi_sun_position(double days, double latitude_deg, double longitude_deg, double *elevation_deg,
                      double *azimuth_deg)
{
    double mean = 280.460 + 0.9856474 * days, anomaly = (357.528 + 0.9856003 * days) * RADIANS;
    double ecliptic = (mean + 1.915 * sin(anomaly) + 0.020 * sin(2 * anomaly)) * RADIANS;
    double tilt = (23.439 - 0.0000004 * days) * RADIANS;
    double ascension = atan2(cos(tilt) * sin(ecliptic), cos(ecliptic));
    double declination = asin(sin(tilt) * sin(ecliptic));
    double hours = 24 * (days - 0.5 - floor(days - 0.5)); /* UTC */
    double sidereal = (6.697375 + 0.0657098242 * days + hours) * 15 + longitude_deg;
    double h = fmod(sidereal, 360) * RADIANS - ascension, latitude = latitude_deg * RADIANS;
    double sine = sin(latitude) * sin(declination) + cos(latitude) * cos(declination) * cos(h);
    *elevation_deg = asin(fmin(1, fmax(-1, sine))) / RADIANS;
    double east = -cos(declination) * sin(h);
    double north = sin(declination) * cos(latitude) - cos(declination) * sin(latitude) * cos(h);
    *azimuth_deg = fmod(atan2(east, north) / RADIANS + 360, 360);
}

/* Days from 2000-01-01 to a date of the Gregorian calendar (Fliegel and Van Flandern 1968). */
static int day_number(int year, int month, int day)
{
    int a = (month - 14) / 12;
    return day - 32075 + 1461 * (year + 4800 + a) / 4 + 367 * (month - 2 - a * 12) / 12 -
           3 * ((year + 4900 + a) / 100) / 4 - 2451545;
}

bool igi_days_of_time(const char *text, double *days)
{
    int year, month, day, hour, minute, used = 0, zone_hour = 0, zone_minute = 0;
    double second = 0;
    char sign = 'Z';
    if (sscanf(text, "%4d-%2d-%2dT%2d:%2d%n", &year, &month, &day, &hour, &minute, &used) != 5)
        return false;
    text += used;
    if (*text == ':') {
        if (sscanf(text, ":%2lf%n", &second, &used) != 1) return false;
        text += used;
    }
    sign = *text++;
    if (sign != 'Z') {
        if (sign != '+' && sign != '-') return false;
        if (sscanf(text, "%2d:%2d%n", &zone_hour, &zone_minute, &used) != 2) return false;
        text += used;
    }
    if (*text || year < 1900 || year > 2100 || month < 1 || month > 12 || day < 1 || day > 31)
        return false;
    if (hour > 24 || minute > 59 || hour < 0 || minute < 0 || !(second >= 0 && second <= 60))
        return false;
    double zone = (zone_hour + zone_minute / 60.0) * (sign == '-' ? -1 : 1);
    *days = day_number(year, month, day) + (hour - 12 - zone) / 24 + minute / 1440.0 +
            second / 86400;
    return true;
}

static igi_status read_range(igi_context *ctx, const igi_json *object, const char *key, double low,
                             double high, double *value)
{
    igi_json at = igi_json_member(object, key);
    if (!at.value) return IGI_OK;
    IGI_TRY(igi_json_number(ctx, &at, value));
    if (*value >= low && *value <= high) return IGI_OK;
    return igi_json_fail(ctx, &at, "is %g; give %g to %g", *value, low, high);
}

static igi_status read_sun(igi_context *ctx, const igi_json *at, igi_sky *sky)
{
    igi_json time = igi_json_member(at, "time"), given = igi_json_member(at, "sun_elevation_deg");
    if (time.value && given.value)
        return igi_json_fail(ctx, &given, "stands beside \"time\"; keep one of them");
    IGI_TRY(read_range(ctx, at, "sun_elevation_deg", 0.1, 90, &sky->sun_elevation_deg));
    IGI_TRY(read_range(ctx, at, "sun_azimuth_deg", -360, 360, &sky->sun_azimuth_deg));
    if (given.value) return IGI_OK;
    double latitude = 100, longitude = 0, days;
    const char *text;
    IGI_TRY(igi_json_string(ctx, &time, &text));
    if (!igi_days_of_time(text, &days))
        return igi_json_fail(ctx, &time,
                             "is no time such as 2026-06-21T12:00:00+02:00 (Z for UTC)");
    IGI_TRY(read_range(ctx, at, "latitude_deg", -90, 90, &latitude));
    IGI_TRY(read_range(ctx, at, "longitude_deg", -180, 180, &longitude));
    if (latitude > 90 || !igi_json_member(at, "longitude_deg").value)
        return igi_json_fail(ctx, at, "has a time but no place; give latitude_deg, longitude_deg");
    igi_sun_position(days, latitude, longitude, &sky->sun_elevation_deg, &sky->sun_azimuth_deg);
    if (sky->sun_elevation_deg >= 0.1) return IGI_OK;
    return igi_json_fail(ctx, &time, "puts the sun %.1f degrees above the horizon: it is night",
                         sky->sun_elevation_deg);
}

igi_status igi_sky_read(igi_context *ctx, const igi_json *at, igi_sky *sky)
{
    *sky = (igi_sky){.given = true, .turbidity = 3};
    IGI_TRY(read_range(ctx, at, "turbidity", 1.7, 10, &sky->turbidity));
    IGI_TRY(read_range(ctx, at, "cloudiness", 0, 1, &sky->cloudiness));
    return read_sun(ctx, at, sky);
}
