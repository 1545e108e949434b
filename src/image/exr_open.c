/* SPDX-License-Identifier: Apache-2.0
 *
 * Opening OpenEXR files, and what their headers say.
 */
#include "image/exr_private.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int64_t read_bytes(exr_const_context_t file, void *user, void *buffer, uint64_t size,
                          uint64_t offset, exr_stream_error_func_ptr_t error)
{
    (void)file;
    (void)error;
    igi_exr_source *from = user;
    if (offset >= from->size) return 0;
    if (size > from->size - offset) size = from->size - offset;
    if (from->fd < 0) {
        memcpy(buffer, from->bytes + offset, size);
        return (int64_t)size;
    }
    uint64_t done = 0;
    while (done < size) {
        ssize_t n = pread(from->fd, (char *)buffer + done, size - done, (off_t)(offset + done));
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) break;
        done += (uint64_t)n;
    }
    return (int64_t)done;
}

static int64_t tell_size(exr_const_context_t file, void *user)
{
    (void)file;
    return (int64_t)((igi_exr_source *)user)->size;
}

static void keep_message(exr_const_context_t file, exr_result_t code, const char *message)
{
    (void)code;
    void *user = NULL;
    if (!file || exr_get_user_data(file, &user) != EXR_ERR_SUCCESS || !user) return;
    igi_exr_source *from = user;
    snprintf(from->message, sizeof from->message, "%s", message);
}

igi_status igi_exr_fail(igi_context *ctx, const igi_exr_source *from, exr_result_t code)
{
    /* Also for EXR_ERR_OUT_OF_MEMORY: OpenEXR's decoders mean a block that claims too much. */
    return igi_fail(ctx, IGI_E_DATA, "%s: not a whole OpenEXR image (%s); export or copy it again",
                    from->name,
                    from->message[0] ? from->message : exr_get_default_error_message(code));
}

igi_status igi_exr_open_file(igi_context *ctx, const char *path, igi_exr_source *from)
{
    struct stat about;
    from->name = path;
    from->fd = open(path, O_RDONLY | O_CLOEXEC);
    if (from->fd < 0 || fstat(from->fd, &about) != 0) {
        bool missing = errno == ENOENT || errno == ENOTDIR || errno == ENAMETOOLONG;
        return igi_fail(ctx, missing ? IGI_E_DATA : IGI_E_SYSTEM,
                        "%s: cannot be opened (%s); check the name and the permissions", path,
                        strerror(errno));
    }
    if (!S_ISREG(about.st_mode))
        return igi_fail(ctx, IGI_E_DATA, "%s: not a file; name an OpenEXR image", path);
    from->size = (uint64_t)about.st_size;
    return IGI_OK;
}

igi_status igi_exr_open(igi_context *ctx, igi_exr_source *from, exr_context_t *file)
{
    exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
    options.error_handler_fn = keep_message;
    options.user_data = from;
    options.read_fn = read_bytes;
    options.size_fn = tell_size;
    options.max_image_width = options.max_image_height = IGI_IMAGE_MAX_SIDE;
    options.max_tile_width = options.max_tile_height = IGI_IMAGE_MAX_SIDE;
    TRY_EXR(exr_start_read(file, from->name, &options));
    return IGI_OK;
}

static igi_status read_window(igi_context *ctx, const igi_exr_source *from, exr_attr_box2i_t box,
                              const char *what, igi_exr_window *out)
{
    int64_t width = (int64_t)box.max.x - box.min.x + 1, height = (int64_t)box.max.y - box.min.y + 1;
    if (width < 1 || height < 1 || width > IGI_IMAGE_MAX_SIDE || height > IGI_IMAGE_MAX_SIDE)
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: its %s window has %lld x %lld pixels; the sides of an image are 1 to "
                        "%d",
                        from->name, what, (long long)width, (long long)height, IGI_IMAGE_MAX_SIDE);
    *out = (igi_exr_window){box.min.x, box.min.y, (int)width, (int)height};
    return IGI_OK;
}

/* The length of the one layer's prefix ("diffuse." in "diffuse.R") whose R, G and B stand for the
 * picture: 0 when bare R, G, B exist or no layer has all three; -1 when several have. */
static int layer_prefix(const exr_attr_chlist_t *list, int *example)
{
    int found = -2;
    for (int i = 0; i < list->num_channels; i++) {
        const char *name = list->entries[i].name.str;
        size_t length = strlen(name);
        if (length < 1 || name[length - 1] != 'R' || (length > 1 && name[length - 2] != '.'))
            continue;
        int complete = 0;
        for (int j = 0; j < list->num_channels; j++) {
            const char *other = list->entries[j].name.str;
            if (strlen(other) != length || strncmp(other, name, length - 1) != 0) continue;
            complete += other[length - 1] == 'G' || other[length - 1] == 'B';
        }
        if (complete != 2) continue;
        if (length == 1) return 0;
        *example = i;
        found = found == -2 ? (int)length - 1 : -1;
    }
    return found == -2 ? 0 : found;
}

static bool has_channel(const exr_attr_chlist_t *list, const char *name)
{
    for (int i = 0; i < list->num_channels; i++)
        if (strcmp(list->entries[i].name.str, name) == 0) return true;
    return false;
}

/* The order in which channels stand: R G B, or a lone Y (not that of X Y Z), then A, then the others
 * by name. */
static int rank(const char *name, const char *first)
{
    const char *at = name[0] && !name[1] ? strchr(first, name[0]) : NULL;
    return at ? (int)(at - first) : (int)strlen(first);
}

static igi_status arrange_channels(igi_context *ctx, const igi_exr_source *from,
                                   const exr_attr_chlist_t *list, igi_exr_layout *out)
{
    int ranks[IGI_EXR_MAX_CHANNELS], example = 0;
    int count = list->num_channels, prefix = layer_prefix(list, &example);
    if (count < 1 || count > IGI_EXR_MAX_CHANNELS)
        return igi_fail(ctx, IGI_E_DATA, "%s: it has %d channels; export 1 to %d of them",
                        from->name, count, IGI_EXR_MAX_CHANNELS);
    if (prefix < 0)
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: several layers have R, G and B (one is '%s'); export one layer",
                        from->name, list->entries[example].name.str);
    const char *base = list->entries[example].name.str;
    out->luma_chroma = has_channel(list, "Y") && has_channel(list, "RY") &&
                       has_channel(list, "BY") && !has_channel(list, "G");
    for (int i = 0; i < count; i++) {
        const exr_attr_chlist_entry_t *entry = &list->entries[i];
        const char *name = entry->name.str;
        if (entry->x_sampling < 1 || entry->y_sampling < 1 || entry->x_sampling > 64 ||
            entry->y_sampling > 64)
            return igi_fail(ctx, IGI_E_DATA, "%s: channel %s is subsampled %d x %d; at most 64",
                            from->name, name, entry->x_sampling, entry->y_sampling);
        out->x_step[i] = entry->x_sampling;
        out->y_step[i] = entry->y_sampling;
        if (prefix > 0 && strncmp(name, base, (size_t)prefix) == 0) name += prefix;
        if (out->luma_chroma) /* each chroma takes the place of the colour it becomes */
            name = strcmp(name, "RY") == 0   ? "R"
                   : strcmp(name, "BY") == 0 ? "B"
                   : strcmp(name, "Y") == 0  ? "G"
                                             : name;
        ranks[i] = rank(name, has_channel(list, "X") ? "RGBA" : "RGBYA");
        out->slot[i] = 0;
        for (int j = 0; j < i; j++) /* the file's order is by name: equal ranks keep it */
            if (ranks[j] <= ranks[i]) out->slot[i]++;
            else out->slot[j]++;
        snprintf(out->names[i], IGI_CHANNEL_NAME_SIZE, "%s", name);
    }
    out->channels = count;
    out->rgb = out->luma_chroma || prefix > 0 ||
               (has_channel(list, "R") && has_channel(list, "G") && has_channel(list, "B"));
    return IGI_OK;
}

igi_status igi_exr_read_header(igi_context *ctx, const igi_exr_source *from, exr_context_t file,
                               igi_exr_layout *out)
{
    exr_storage_t storage;
    exr_attr_box2i_t box;
    const exr_attr_chlist_t *list;
    const exr_attribute_t *attribute;
    memset(out, 0, sizeof *out);
    TRY_EXR(exr_get_storage(file, 0, &storage));
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: it holds deep data (several samples a pixel); flatten it first",
                        from->name);
    out->tiled = storage == EXR_STORAGE_TILED;
    TRY_EXR(exr_get_data_window(file, 0, &box));
    IGI_TRY(read_window(ctx, from, box, "data", &out->data));
    TRY_EXR(exr_get_display_window(file, 0, &box));
    IGI_TRY(read_window(ctx, from, box, "display", &out->display));
    TRY_EXR(exr_get_channels(file, 0, &list));
    IGI_TRY(arrange_channels(ctx, from, list, out));
    size_t data = (size_t)out->data.width * (size_t)out->data.height;
    size_t display = (size_t)out->display.width * (size_t)out->display.height;
    if ((data > display ? data : display) > IGI_IMAGE_MAX_SAMPLES / (size_t)out->channels)
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: %d x %d pixels with %d channels are more than igi reads; scale it "
                        "down",
                        from->name, out->data.width, out->data.height, out->channels);
    if (exr_get_attribute_by_name(file, 0, IGI_EXR_DEVIATION, &attribute) == EXR_ERR_SUCCESS &&
        attribute->type == EXR_ATTR_FLOAT && attribute->f > 0 && attribute->f < 10)
        out->deviation = attribute->f;
    out->chromaticities = igi_rec709;
    if (exr_get_attribute_by_name(file, 0, "chromaticities", &attribute) == EXR_ERR_SUCCESS &&
        attribute->type == EXR_ATTR_CHROMATICITIES) {
        const exr_attr_chromaticities_t *c = attribute->chromaticities;
        out->has_chromaticities = true;
        out->chromaticities = (igi_chromaticities){{{(double)c->red_x, (double)c->red_y},
                                                    {(double)c->green_x, (double)c->green_y},
                                                    {(double)c->blue_x, (double)c->blue_y},
                                                    {(double)c->white_x, (double)c->white_y}}};
    }
    return IGI_OK;
}

igi_status igi_image_probe_exr(igi_context *ctx, const char *path, int *width, int *height,
                               int *channels, int *bands)
{
    igi_status status = IGI_OK;
    exr_context_t file = NULL;
    igi_exr_source from = {.fd = -1};
    igi_exr_layout l;
    *width = *height = *channels = *bands = 0;
    IGI_TRY_GOTO(igi_exr_open_file(ctx, path, &from));
    IGI_TRY_GOTO(igi_exr_open(ctx, &from, &file));
    IGI_TRY_GOTO(igi_exr_read_header(ctx, &from, file, &l));
    *width = l.display.width;
    *height = l.display.height;
    *channels = *bands = l.channels;
    for (int i = 0; i < l.channels; i++)
        *bands -= strcmp(l.names[i], "A") == 0 || strcmp(l.names[i], "saturated") == 0 ||
                  strncmp(l.names[i], "variance.", 9) == 0;
cleanup:
    if (file) exr_finish(&file);
    if (from.fd >= 0) close(from.fd);
    return status;
}
