//! NAV-SAT by hand: what bench/nav_sat.py holds the generated decoder against.

#[derive(Clone, Copy, Default)]
pub struct Satellite {
    pub gnss_id: u8,
    pub sv_id: u8,
    pub cno: u8,
    pub elev: i8,
    pub azim: i16,
    pub pr_res: i16,
    pub quality_ind: u8,
    pub sv_used: bool,
    pub health: u8,
    pub diff_corr: bool,
    pub smoothed: bool,
    pub orbit_source: u8,
    pub eph_avail: bool,
    pub alm_avail: bool,
    pub ano_avail: bool,
    pub aop_avail: bool,
    pub sbas_corr_used: bool,
    pub rtcm_corr_used: bool,
    pub slas_corr_used: bool,
    pub spartn_corr_used: bool,
    pub pr_corr_used: bool,
    pub cr_corr_used: bool,
    pub do_corr_used: bool,
    pub clas_corr_used: bool,
    pub lpp_corr_used: bool,
    pub has_corr_used: bool,
}

#[derive(Clone, Copy)]
pub struct NavSat {
    pub i_tow: u32,
    pub version: u8,
    pub num_svs: u8,
    pub satellites: [Satellite; 64],
}

pub struct WrongLength;

pub fn decode(b: &[u8]) -> Result<NavSat, WrongLength> {
    if b.len() < 8 || b[5] > 64 || b.len() != 8 + 12 * usize::from(b[5]) {
        return Err(WrongLength);
    }
    let mut m = NavSat {
        i_tow: u32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        version: b[4],
        num_svs: b[5],
        satellites: [Satellite::default(); 64],
    };
    for (s, p) in m.satellites.iter_mut().zip(b[8..].chunks_exact(12)) {
        let flags = u32::from_le_bytes([p[8], p[9], p[10], p[11]]);
        *s = Satellite {
            gnss_id: p[0],
            sv_id: p[1],
            cno: p[2],
            elev: p[3] as i8,
            azim: i16::from_le_bytes([p[4], p[5]]),
            pr_res: i16::from_le_bytes([p[6], p[7]]),
            quality_ind: (flags & 7) as u8,
            sv_used: flags & 1 << 3 != 0,
            health: (flags >> 4 & 3) as u8,
            diff_corr: flags & 1 << 6 != 0,
            smoothed: flags & 1 << 7 != 0,
            orbit_source: (flags >> 8 & 7) as u8,
            eph_avail: flags & 1 << 11 != 0,
            alm_avail: flags & 1 << 12 != 0,
            ano_avail: flags & 1 << 13 != 0,
            aop_avail: flags & 1 << 14 != 0,
            sbas_corr_used: flags & 1 << 16 != 0,
            rtcm_corr_used: flags & 1 << 17 != 0,
            slas_corr_used: flags & 1 << 18 != 0,
            spartn_corr_used: flags & 1 << 19 != 0,
            pr_corr_used: flags & 1 << 20 != 0,
            cr_corr_used: flags & 1 << 21 != 0,
            do_corr_used: flags & 1 << 22 != 0,
            clas_corr_used: flags & 1 << 23 != 0,
            lpp_corr_used: flags & 1 << 24 != 0,
            has_corr_used: flags & 1 << 25 != 0,
        };
    }
    Ok(m)
}
