from icdgen import link as link
