/* SPDX-License-Identifier: Apache-2.0
 *
 * The one table of options: parsing, range checks, defaults, help and the manifest come from it.
 */
#include "cli.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

typedef enum option_kind { FLAG, TEXT, CHOICE, WHOLE, REAL } option_kind;

typedef struct option {
    const char *name;
    char letter; /* 0: none */
    option_kind kind;
    unsigned commands;
    size_t offset;        /* in cli_values */
    const char *value;    /* its name in the help, or the choices: a|b */
    const char *standard; /* the default; NULL: none */
    double low, high;
    const char *help;
} option;

#define AT(field) offsetof(cli_values, field)
#define MANY 1e6

static const option options[] = {
    {"output", 'o', TEXT,
     CLI_RECOVER | CLI_SYNTH | CLI_MERGE | CLI_CALIBRATE | CLI_CORRECT | CLI_RELIGHT | CLI_CHART |
         CLI_EXPORT | CLI_REGISTER | CLI_CHECK,
     AT(output), "PATH", NULL, 0, 0, "where to write; it appears whole or not at all"},
    {"list", 0, TEXT, CLI_MERGE, AT(list), "FILE", NULL, 0, 0,
     "a line an image: NAME SECONDS [F-NUMBER [ISO]]; without it, EXIF"},
    {"response", 0, TEXT, CLI_MERGE, AT(response),
     "auto|linear|srgb|recovered|polynomial|emor|debevec|robertson|FILE", "auto", 0, 0,
     "codes to light; FILE is a calibration that has a response"},
    {"basis", 0, TEXT, CLI_MERGE | CLI_SYNTH, AT(basis), "FILE", NULL, 0, 0,
     "table of known responses (EMoR's invemor.txt, not igi's): for --response emor, --photos"},
    {"weights", 0, CHOICE, CLI_MERGE, AT(weights), "photon|debevec|robertson", "photon", 0, 0,
     "how exposures are weighed; the last two are OpenCV's, for comparison"},
    {"no-align", 0, FLAG, CLI_MERGE, AT(no_align), NULL, NULL, 0, 0,
     "do not look for shifts between the exposures"},
    {"no-refine", 0, FLAG, CLI_MERGE, AT(no_refine), NULL, NULL, 0, 0,
     "take exposure ratios as stated, even where the pictures know better"},
    {"full-well", 0, REAL, CLI_MERGE, AT(full_well), "ELECTRONS", "0", 0, MANY,
     "at the highest code; 0: not known, the scatter is measured"},
    {"read-noise", 0, REAL, CLI_MERGE, AT(read_noise), "CODES", "0", 0, 65535,
     "standard deviation; 0: 2.5 of 256 or 12 of 65536"},
    {"save-response", 0, TEXT, CLI_MERGE, AT(save_response), "FILE", NULL, 0, 0,
     "write the response into this calibration"},
    {"chessboard", 0, TEXT, CLI_CALIBRATE, AT(chessboard), "COLUMNSxROWS", NULL, 0, 0,
     "the images show a board with so many inner corners"},
    {"charuco", 0, TEXT, CLI_CALIBRATE, AT(charuco), "COLUMNSxROWS", NULL, 0, 0,
     "the same with a marker in each white square: part of the board is enough"},
    {"markers", 0, TEXT, CLI_CALIBRATE, AT(markers), "NAME", "5X5_100", 0, 0,
     "with --charuco: OpenCV's name of the markers, 4X4_50 to 7X7_1000"},
    {"marker", 0, REAL, CLI_CALIBRATE, AT(marker), "METRES", "0", 0, MANY,
     "with --charuco: side of the markers"},
    {"lensfun", 0, FLAG, CLI_CALIBRATE, AT(lensfun), NULL, NULL, 0, 0,
     "look the lens up in lensfun's database, by the EXIF of one photograph"},
    {"lens", 0, TEXT, CLI_CALIBRATE, AT(lens), "NAME", NULL, 0, 0,
     "with --lensfun: the lens, where EXIF does not name it"},
    {"square", 0, REAL, CLI_CALIBRATE, AT(square), "METRES", "0", 0, MANY,
     "side of the board's squares"},
    {"residuals", 0, TEXT, CLI_CALIBRATE, AT(residuals), "FILE.svg", NULL, 0, 0,
     "with a board: a picture of what the lens leaves at each corner, and each view's RMS"},
    {"convert", 0, TEXT, CLI_CALIBRATE, AT(convert), "FILE", NULL, 0, 0,
     "lens of OpenCV (.yml, .xml) or COLMAP (cameras.txt, .bin), or igi's; -o .json, .yml or .txt"},
    {"flat", 0, FLAG, CLI_CALIBRATE, AT(flat), NULL, NULL, 0, 0,
     "the images show an evenly lit surface that fills the frame"},
    {"photos", 0, FLAG, CLI_SYNTH, AT(photos), NULL, NULL, 0, 0,
     "photographs as a camera delivers them: brackets, lens, noise"},
    {"overlap", 0, TEXT, CLI_CALIBRATE, AT(overlap), "SCENE", NULL, 0, 0,
     "vignetting from the overlapping images of a scene with known geometry"},
    {"calibration", 0, TEXT, CLI_CORRECT, AT(calibration), "FILE", NULL, 0, 0,
     "what igi calibrate wrote"},
    {"points", 0, TEXT, CLI_REGISTER, AT(points), "FILE", NULL, 0, 0,
     "points known in both frames, a line each: X Y Z of the cameras' X Y Z of the mesh's"},
    {"together", 0, FLAG, CLI_REGISTER, AT(together), NULL, NULL, 0, 0,
     "first move all cameras as one (turn, shift and scale); --points does so anyway"},
    {"search", 0, REAL, CLI_REGISTER, AT(search), "PIXELS", "4", 2, 10,
     "how far the photographs' edges may lie off the mesh's at the start"},
    {"truth", 0, TEXT, CLI_VALIDATE | CLI_REPORT, AT(truth), "FOLDER", NULL, 0, 0,
     "the scene's truth folder, with truth.json"},
    {"tolerance", 0, REAL, CLI_VALIDATE, AT(tolerance), "E", "0", 0, MANY,
     "exit with 1 when the mean albedo error is above it; a fraction, 0: never"},
    {"method", 0, CHOICE, CLI_RECOVER, AT(method), "patches|gather|radiosity|direct|yu99",
     "patches", 0, 0, "how light between surfaces is reckoned"},
    {"gather-from", 0, CHOICE, CLI_RECOVER, AT(gather_from), "patches|photos", "patches", 0, 0,
     "with --method gather: where the light that a ray meets is looked up"},
    {"form-factors", 0, CHOICE, CLI_RECOVER, AT(form_factors), "rays|hemicube|closed", "rays", 0, 0,
     "with --method radiosity: how form factors are reckoned; closed: as if nothing stood between"},
    {"model", 0, CHOICE, CLI_RECOVER, AT(model), "auto|lambert|ward|ggx|phong", "auto", 0, 0,
     "reflectance of the surfaces; auto: what the photographs ask for, region by region"},
    {"register", 0, CHOICE, CLI_RECOVER, AT(registering), "auto|never|always", "auto", 0, 0,
     "cameras moved first until the photographs' edges lie on the mesh's; auto: where they are "
     "clearly off"},
    {"target-error", 0, REAL, CLI_RECOVER, AT(target_error), "E", "0", 0, 1,
     "relative error of albedo to aim at, a fraction: as few photographs, pixels and rays as do; "
     "0: as it comes"},
    {"target-error", 0, REAL, CLI_RELIGHT, AT(target_error), "E", "0", 0, 1,
     "noise of a pixel to aim at, a fraction of the mean pixel; 0: as it comes"},
    {"time-budget", 0, REAL, CLI_RECOVER, AT(time_budget), "SECONDS", "0", 0, MANY,
     "CPU seconds to aim at; 0: no limit"},
    {"patch", 0, REAL, CLI_RECOVER, AT(patch), "METRES", "0", 0, MANY,
     "side of a patch; 0: from the size of the room"},
    {"rays", 0, WHOLE, CLI_RECOVER, AT(rays), "N", "0", 0, MANY,
     "rays from each patch; 0: the method's own"},
    {"map-size", 0, WHOLE, CLI_RECOVER, AT(map_size), "TEXELS", "0", 0, 16384,
     "side of an albedo map; 0: as fine as the photographs"},
    {"to", 0, CHOICE, CLI_EXPORT, AT(to), "glb|obj|mitsuba|pbrt|radiance", NULL, 0, 0,
     "the program to write for"},
    {"lights", 0, TEXT, CLI_RELIGHT | CLI_EXPORT, AT(lights), "FILE", NULL, 0, 0,
     "JSON with the lights that are on, as in scene.json; without it, the result's own"},
    {"relight", 0, FLAG, CLI_REPORT, AT(relight), NULL, NULL, 0, 0,
     "render a picture for each lamp, to be relit by hand on the page"},
    {"cameras", 0, TEXT, CLI_RELIGHT | CLI_EXPORT | CLI_REPORT, AT(cameras), "FILE", NULL, 0, 0,
     "transforms.json, or a COLMAP folder: the views"},
    {"sensors", 0, TEXT, CLI_RELIGHT, AT(sensors), "FILE", NULL, 0, 0,
     "points that measure light, a line each: X Y Z and the way it faces; illuminance in lux"},
    {"samples", 0, WHOLE, CLI_RELIGHT | CLI_REPORT, AT(samples), "N", "0", 0, MANY,
     "paths a pixel; noise falls with their square root; 0: 64, or 8 for a preview"},
    {"insert", 0, TEXT, CLI_RELIGHT, AT(insert), "FILE", NULL, 0, 0,
     "a mesh to put into the scene: an OBJ in its coordinates, with an MTL"},
    {"materials", 0, TEXT, CLI_RELIGHT, AT(edits), "FILE", NULL, 0, 0,
     "JSON with \"regions\" as in materials.json, those that change, and of them what changes"},
    {"method", 0, CHOICE, CLI_RELIGHT, AT(forward), "path|direct|whitted|radiosity|progressive",
     "path", 0, 0, "how light is followed; but for path, textbook methods to compare with"},
    {"preview", 0, FLAG, CLI_RELIGHT, AT(preview), NULL, NULL, 0, 0,
     "quick: radiosity for all but direct light and one bounce"},
    {"variance", 0, FLAG, CLI_RELIGHT, AT(variance), NULL, NULL, 0, 0,
     "write NAME.variance.exr too, the variance of each pixel's mean"},
    {"sigma", 0, FLAG, CLI_RELIGHT, AT(sigma), NULL, NULL, 0, 0,
     "write NAME.sigma.exr too: how uncertain each pixel is, because the materials are"},
    {"aov", 0, FLAG, CLI_RELIGHT, AT(aov), NULL, NULL, 0, 0,
     "write NAME.layers.exr too: albedo, direct and indirect light, variance"},
    {"png", 0, FLAG, CLI_RELIGHT, AT(png), NULL, NULL, 0, 0,
     "write NAME.png too, tone-mapped alike for all views"},
    {"scenes", 0, TEXT, CLI_CHART, AT(scenes), "A,B", NULL, 0, 0,
     "specs of rooms; speed, parsimony: or scene folders with truth/; default: the standard ones"},
    {"sweeps", 0, TEXT, CLI_CHART, AT(sweeps), "A,B", NULL, 0, 0,
     "names of sweeps, or their files; default: all"},
    {"seeds", 0, WHOLE, CLI_CHART, AT(seeds), "N", "0", 0, 1000,
     "of each severity; 0: as the sweep says"},
    {"small", 0, FLAG, CLI_CHART, AT(small), NULL, NULL, 0, 0,
     "less of everything: a first look within a minute"},
    {"datasets", 0, TEXT, CLI_CHART, AT(datasets), "FOLDER", "datasets-synthetic", 0, 0,
     "the folder of specs and of sweeps/"},
    {"cache", 0, TEXT, CLI_CHART, AT(cache), "FOLDER", NULL, 0, 0,
     "keep rendered rooms here for the next run"},
    {"peer", 0, TEXT, CLI_CHART, AT(peer), "FILE.csv", NULL, 0, 0,
     "speed: other programs' curves, as scripts/peers write them"},
    {"relit", 0, FLAG, CLI_CHART, AT(relit), NULL, NULL, 0, 0,
     "speed: relight each result, too; scenes with relit/lights.json"},
    {"threads", 'j', WHOLE, CLI_ALL, AT(threads), "N", "0", 0, 256,
     "threads to work with; 0: one for each processor"},
    {"seed", 0, WHOLE, CLI_ALL, AT(seed), "N", "1", 0, 9007199254740992.0,
     "of all random numbers; the same seed gives the same bytes"},
    {"force", 'f', FLAG,
     CLI_RECOVER | CLI_SYNTH | CLI_CORRECT | CLI_RELIGHT | CLI_CHART | CLI_CHECK, AT(force), NULL,
     NULL, 0, 0, "replace a folder that igi did not write"},
    {"dry-run", 'n', FLAG, CLI_RECOVER, AT(dry_run), NULL, NULL, 0, 0,
     "check the input, say what would be done, write nothing"},
    {"json", 0, FLAG, CLI_ALL, AT(json), NULL, NULL, 0, 0, "print the result as JSON"},
    {"quiet", 'q', FLAG, CLI_ALL, AT(quiet), NULL, NULL, 0, 0,
     "no progress, no warnings, no table"},
    {"verbose", 'v', FLAG, CLI_ALL, AT(verbose), NULL, NULL, 0, 0,
     "say what each stage cost in time, rays and memory"},
    {"help", 'h', FLAG, CLI_ALL, AT(help), NULL, NULL, 0, 0, "this text"},
};

enum { OPTION_COUNT = sizeof options / sizeof options[0] };

static bool is_choice(const char *choices, const char *text)
{
    size_t length = strlen(text);
    for (const char *at = choices; length && at; at = strchr(at, '|')) {
        at += *at == '|';
        if (strncmp(at, text, length) == 0 && (at[length] == '|' || at[length] == 0)) return true;
    }
    return false;
}

/* Stores the value; NULL, or what is wrong with it. */
static const char *store(cli_values *values, const option *o, const char *text)
{
    void *field = (char *)values + o->offset;
    if (o->kind == FLAG) *(bool *)field = true;
    if (o->kind == CHOICE && !is_choice(o->value, text)) return "must be one of";
    if (o->kind == TEXT && !text[0]) return "must not be empty:";
    if (o->kind == CHOICE || o->kind == TEXT) *(const char **)field = text;
    if (o->kind != WHOLE && o->kind != REAL) return NULL;
    char *end = NULL;
    double x = strtod(text, &end);
    if (end == text || *end || !isfinite(x)) return "must be a number:";
    if (o->kind == WHOLE && x != floor(x)) return "must be a whole number:";
    if (x < o->low || x > o->high) return "is out of range:";
    *(double *)field = x;
    return NULL;
}

/* The command's own, where commands have options of one name with different values. */
static const option *find_long(const char *name, size_t length, unsigned command)
{
    const option *found = NULL;
    for (size_t i = 0; i < OPTION_COUNT; i++) {
        const option *o = &options[i];
        if (strlen(o->name) != length || strncmp(o->name, name, length) != 0) continue;
        if (!found || (o->commands & command)) found = o;
    }
    return found;
}

static const option *find_letter(char letter)
{
    for (size_t i = 0; i < OPTION_COUNT; i++)
        if (options[i].letter && options[i].letter == letter) return &options[i];
    return NULL;
}

static bool say_unknown(const cli_command *command, const char *word)
{
    const char *names[OPTION_COUNT + 1], *nearest = NULL;
    size_t count = 0;
    char name[64];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(word + 2, "="),
             word[1] == '-' ? word + 2 : "");
    for (size_t i = 0; i < OPTION_COUNT; i++)
        if (options[i].commands & command->bit) names[count++] = options[i].name;
    names[count] = NULL;
    if (name[0]) nearest = cli_nearest(name, names);
    if (nearest)
        fprintf(stderr, "igi: %s: there is no such option; did you mean --%s?\n", word, nearest);
    else
        fprintf(stderr, "igi: %s: there is no such option; see igi help %s\n", word, command->name);
    return false;
}

/* Reads one option at argv[*at] and moves *at past its value. */
static bool parse_option(cli_session *s, int argc, char **argv, int *at)
{
    const char *word = argv[*at], *value = NULL;
    const option *o;
    if (word[1] == '-') {
        size_t length = strcspn(word + 2, "=");
        o = find_long(word + 2, length, s->command->bit);
        if (word[2 + length] == '=') value = word + 3 + length;
    } else {
        o = find_letter(word[1]);
        if (word[2]) value = word + 2;
    }
    if (!o || !(o->commands & s->command->bit)) return say_unknown(s->command, word);
    if (o->kind == FLAG && value) {
        fprintf(stderr, "igi: %s: --%s takes no value\n", word, o->name);
        return false;
    }
    if (o->kind != FLAG && !value) {
        if (*at + 1 >= argc) {
            fprintf(stderr, "igi: %s: its value is missing: %s\n", word, o->value);
            return false;
        }
        value = argv[++*at];
    }
    const char *wrong = store(&s->values, o, value);
    if (!wrong) return true;
    fprintf(stderr, "igi: --%s '%s': %s %s", o->name, value, wrong, o->value);
    if (o->kind == WHOLE || o->kind == REAL)
        fprintf(stderr, " from %.16g to %.16g", o->low, o->high);
    fputs("\n", stderr);
    return false;
}

bool cli_parse(cli_session *s, int argc, char **argv)
{
    bool only_arguments = false;
    for (size_t i = 0; i < OPTION_COUNT; i++)
        if (options[i].standard) (void)store(&s->values, &options[i], options[i].standard);
    for (int at = 0; at < argc; at++) {
        const char *word = argv[at];
        if (only_arguments || word[0] != '-' || !word[1]) {
            if (s->argument_count == CLI_MAX_ARGUMENTS) {
                fprintf(stderr, "igi: %s: more than %d arguments\n", word, CLI_MAX_ARGUMENTS);
                return false;
            }
            s->arguments[s->argument_count++] = word;
        } else if (strcmp(word, "--") == 0) {
            only_arguments = true;
        } else if (!parse_option(s, argc, argv, &at)) {
            return false;
        }
    }
    int given = s->argument_count, needed = s->command->arguments;
    if (s->values.help || given == needed || (s->command->more && given > needed)) return true;
    fprintf(stderr, "igi: %s: %d argument%s given, %d%s needed: igi %s\n", s->command->name, given,
            given == 1 ? "" : "s", needed, s->command->more ? " or more" : "", s->command->usage);
    return false;
}

void cli_each_option(unsigned command, cli_option_fn print)
{
    for (size_t i = 0; i < OPTION_COUNT; i++) {
        const option *o = &options[i];
        if (!(o->commands & command)) continue;
        char names[128];
        snprintf(names, sizeof names, "%s%c%s --%s%s%s", o->letter ? "-" : " ",
                 o->letter ? o->letter : ' ', o->letter ? "," : " ", o->name, o->value ? " " : "",
                 o->value ? o->value : "");
        print(names, o->help, o->standard);
    }
}

size_t cli_settings(const cli_session *s, igi_setting *settings, char text[][32], size_t room)
{
    size_t count = 0;
    for (size_t i = 0; i < OPTION_COUNT && count < room; i++) {
        const option *o = &options[i];
        if (!(o->commands & s->command->bit) || o->kind == FLAG) continue;
        const void *field = (const char *)&s->values + o->offset;
        settings[count] = (igi_setting){o->name, text[count]};
        if (o->kind == TEXT || o->kind == CHOICE)
            settings[count].value = *(const char *const *)field;
        else snprintf(text[count], 32, "%.16g", *(const double *)field);
        count += settings[count].value != NULL;
    }
    return count;
}
