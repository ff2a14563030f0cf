from icdgen import link as link  # makes the runtime importable
