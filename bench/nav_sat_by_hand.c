/* NAV-SAT as shift-and-mask code by hand: what bench/nav_sat.py holds the generated decoder against. */

#include "ublox.h"

int hand_decode(ublox_nav_sat_t *m, const uint8_t *b, size_t length);
void hand_encode(const ublox_nav_sat_t *m, uint8_t *b);

int hand_decode(ublox_nav_sat_t *m, const uint8_t *b, size_t length)
{
    size_t i;
    if (length < 8 || b[5] > 64 || length != 8 + 12 * (size_t)b[5]) {
        return -1;
    }
    m->i_tow = (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
    m->version = b[4];
    m->num_svs = b[5];
    for (i = 0; i < b[5]; i++) {
        ublox_satellite_t *s = &m->satellites[i];
        const uint8_t *p = b + 8 + 12 * i;
        const uint32_t flags = (uint32_t)p[8] | (uint32_t)p[9] << 8 | (uint32_t)p[10] << 16 | (uint32_t)p[11] << 24;
        s->gnss_id = p[0];
        s->sv_id = p[1];
        s->cno = p[2];
        s->elev = (int8_t)p[3];
        s->azim = (int16_t)(p[4] | p[5] << 8);
        s->pr_res = (int16_t)(p[6] | p[7] << 8);
        s->quality_ind = flags & 7;
        s->sv_used = flags >> 3 & 1;
        s->health = flags >> 4 & 3;
        s->diff_corr = flags >> 6 & 1;
        s->smoothed = flags >> 7 & 1;
        s->orbit_source = flags >> 8 & 7;
        s->eph_avail = flags >> 11 & 1;
        s->alm_avail = flags >> 12 & 1;
        s->ano_avail = flags >> 13 & 1;
        s->aop_avail = flags >> 14 & 1;
        s->sbas_corr_used = flags >> 16 & 1;
        s->rtcm_corr_used = flags >> 17 & 1;
        s->slas_corr_used = flags >> 18 & 1;
        s->spartn_corr_used = flags >> 19 & 1;
        s->pr_corr_used = flags >> 20 & 1;
        s->cr_corr_used = flags >> 21 & 1;
        s->do_corr_used = flags >> 22 & 1;
        s->clas_corr_used = flags >> 23 & 1;
        s->lpp_corr_used = flags >> 24 & 1;
        s->has_corr_used = flags >> 25 & 1;
    }
    return 0;
}

void hand_encode(const ublox_nav_sat_t *m, uint8_t *b)
{
    size_t i;
    b[0] = (uint8_t)m->i_tow;
    b[1] = (uint8_t)(m->i_tow >> 8);
    b[2] = (uint8_t)(m->i_tow >> 16);
    b[3] = (uint8_t)(m->i_tow >> 24);
    b[4] = m->version;
    b[5] = m->num_svs;
    b[6] = b[7] = 0;
    for (i = 0; i < m->num_svs; i++) {
        const ublox_satellite_t *s = &m->satellites[i];
        uint8_t *p = b + 8 + 12 * i;
        const uint32_t flags = s->quality_ind | (uint32_t)s->sv_used << 3 | (uint32_t)s->health << 4 |
            (uint32_t)s->diff_corr << 6 | (uint32_t)s->smoothed << 7 | (uint32_t)s->orbit_source << 8 |
            (uint32_t)s->eph_avail << 11 | (uint32_t)s->alm_avail << 12 | (uint32_t)s->ano_avail << 13 |
            (uint32_t)s->aop_avail << 14 | (uint32_t)s->sbas_corr_used << 16 | (uint32_t)s->rtcm_corr_used << 17 |
            (uint32_t)s->slas_corr_used << 18 | (uint32_t)s->spartn_corr_used << 19 | (uint32_t)s->pr_corr_used << 20 |
            (uint32_t)s->cr_corr_used << 21 | (uint32_t)s->do_corr_used << 22 | (uint32_t)s->clas_corr_used << 23 |
            (uint32_t)s->lpp_corr_used << 24 | (uint32_t)s->has_corr_used << 25;
        p[0] = s->gnss_id;
        p[1] = s->sv_id;
        p[2] = s->cno;
        p[3] = (uint8_t)s->elev;
        p[4] = (uint8_t)s->azim;
        p[5] = (uint8_t)((uint16_t)s->azim >> 8);
        p[6] = (uint8_t)s->pr_res;
        p[7] = (uint8_t)((uint16_t)s->pr_res >> 8);
        p[8] = (uint8_t)flags;
        p[9] = (uint8_t)(flags >> 8);
        p[10] = (uint8_t)(flags >> 16);
        p[11] = (uint8_t)(flags >> 24);
    }
}
