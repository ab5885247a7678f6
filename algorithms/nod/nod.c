/* Nods the head: a human algorithm in C with no library but libc. See docs/protocol.md.
 *
 * Numbers go over the pipes as they lie in memory, so this is for little-endian machines (x86, ARM, RISC-V).
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { START = 1, FRAME = 2, STOP = 3, READY = 16, POSE = 17, DONE = 20 };
enum { FRAME_SIZE = 190, ROTATIONS = 4, HEAD = 2, POSE_SIZE = 260, IMPORTANCE = 176 };

/* Read exactly `size` bytes; 0 at the end of the input. */
static int get(void *into, size_t size)
{
    for (size_t got = 0; got < size;) {
        ssize_t part = read(0, (char *)into + got, size - got);
        if (part <= 0)
            return 0;
        got += (size_t)part;
    }
    return 1;
}

static void put(const void *from, size_t size)
{
    for (size_t sent = 0; sent < size;) {
        ssize_t part = write(1, (const char *)from + sent, size - sent);
        if (part <= 0)
            exit(1);
        sent += (size_t)part;
    }
}

/* Send a message in one write: length u32, kind u8, payload. */
static void send_message(uint8_t kind, const void *payload, uint32_t length)
{
    char message[5 + POSE_SIZE * sizeof(double)];
    memcpy(message, &length, 4);
    message[4] = (char)kind;
    memcpy(message + 5, payload, length);
    put(message, 5 + length);
}

/* Read a message into memory that the caller frees, with a 0 behind it; NULL at the end of the input. */
static char *get_message(uint8_t *kind, uint32_t *length)
{
    if (!get(length, 4) || !get(kind, 1))
        return NULL;
    char *payload = malloc((size_t)*length + 1);
    if (payload == NULL || !get(payload, *length))
        return NULL;
    payload[*length] = 0;
    return payload;
}

/* The number of `key`, found at `depth` braces into a JSON text; `otherwise` where there is none. */
static double number(const char *json, int depth, const char *key, double otherwise)
{
    size_t size = strlen(key);
    for (int deep = 0; *json; json++) {
        if (*json == '{' || *json == '[')
            deep++;
        else if (*json == '}' || *json == ']')
            deep--;
        else if (*json == '"') {
            const char *text = ++json;
            for (; *json && *json != '"'; json++)
                if (*json == '\\' && json[1])
                    json++;
            if (!*json)
                break;
            if (deep == depth && (size_t)(json - text) == size && !memcmp(text, key, size) && json[1] == ':')
                return strtod(json + 2, NULL);
        }
    }
    return otherwise;
}

/* Turn the quaternion `head` (w x y z) about its own y by `angle` radians, into `out`: its product with
 * (cos(angle/2), 0, sin(angle/2), 0), which needs no sine: with u the tangent of a quarter of the angle, near angle/4
 * for a nod, (1-u*u, 2u)/(1+u*u) is a cosine and a sine, and the quaternion is a unit one whatever u is. */
static void bow(const double head[4], double angle, double out[4])
{
    double u = angle / 4, c = (1 - u * u) / (1 + u * u), s = 2 * u / (1 + u * u);
    out[0] = head[0] * c - head[2] * s;
    out[1] = head[1] * c - head[3] * s;
    out[2] = head[2] * c + head[0] * s;
    out[3] = head[3] * c + head[1] * s;
}

int main(void)
{
    double frames = 60, depth = 0.4, head[4] = {1, 0, 0, 0}, pose[POSE_SIZE];
    uint8_t kind;
    uint32_t length;
    char *payload;

    while ((payload = get_message(&kind, &length)) != NULL && kind != STOP) {
        if (kind == START) {
            frames = number(payload, 1, "frames", frames);
            depth = number(payload, 2, "depth", depth); /* parameters.depth */
            send_message(READY, "{\"version\":1}", 13);
        } else if (kind == FRAME && length >= FRAME_SIZE * sizeof(double)) {
            memset(pose, 0, sizeof pose);
            memcpy(pose, payload, IMPORTANCE * sizeof(double)); /* k, root, rotations: as they are ... */
            double k = pose[0], t = k / frames, *q = pose + ROTATIONS + 4 * HEAD;
            if (k == 1)
                memcpy(head, q, sizeof head);
            bow(head, depth * 16 * t * t * (1 - t) * (1 - t), q); /* ... but for the head, down and up again */
            pose[IMPORTANCE + HEAD] = 1; /* and nothing else matters to a nod */
            send_message(POSE, pose, sizeof pose);
            if (k >= frames) {
                send_message(DONE, "", 0);
                break;
            }
        }
        free(payload);
    }
    return 0;
}
