/* SPDX-License-Identifier: Apache-2.0 */
/* Takes the place of libjbig.so.0 in wheels. Debian's libtiff needs that library for TIFF pages that
 * are compressed by JBIG, but it is under the GNU GPL, which a wheel under the Apache License cannot
 * contain. Here each decoding fails, so that libtiff reports such a page as one it cannot decode. */
#include <stddef.h>

enum { NOT_SUPPORTED = 1 };

const char *jbg_strerror(int status) {
  (void)status;
  return "JBIG is not supported in this build of isoatlas";
}

/* The callers own the states, which stay untouched. */
void jbg_dec_init(void *state) { (void)state; }
void jbg_dec_free(void *state) { (void)state; }
int jbg_newlen(unsigned char *data, size_t size) {
  (void)data;
  (void)size;
  return NOT_SUPPORTED;
}
int jbg_dec_in(void *state, unsigned char *data, size_t size, size_t *used) {
  (void)state;
  (void)data;
  (void)size;
  if (used != NULL) *used = 0;
  return NOT_SUPPORTED;
}
unsigned long jbg_dec_getsize(const void *state) {
  (void)state;
  return 0;
}
unsigned char *jbg_dec_getimage(const void *state, int plane) {
  (void)state;
  (void)plane;
  return NULL;
}

/* isoatlas writes no TIFF files, so nothing is encoded. */
void jbg_enc_init(void *state, unsigned long x, unsigned long y, int planes, unsigned char **image,
                  void (*write)(unsigned char *data, size_t size, void *file), void *file) {
  (void)state, (void)x, (void)y, (void)planes, (void)image, (void)write, (void)file;
}
void jbg_enc_out(void *state) { (void)state; }
void jbg_enc_free(void *state) { (void)state; }
